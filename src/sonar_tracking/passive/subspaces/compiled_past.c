/* PAST and OPAST, all snapshots of a portion at once: past_recursion.py, compiled.
 *
 * A snapshot costs a few operations an element: in numpy the calls cost more than the work. Matrices
 * are kept by columns, real and imaginary parts apart, so that the loops over the elements need no
 * shuffling. Every sum is taken in the order in which past_recursion.py takes it, and no operation
 * is contracted: both give the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LANES 4 /* partial sums of a scalar product */

typedef struct {
    Py_ssize_t elements, columns;
    double *basis_re, *basis_im;         /* W, column after column */
    double *inverse_re, *inverse_im;     /* P, row after row */
    double *x_re, *x_im;                 /* snapshot, then what W does not explain of it */
    double *y_re, *y_im, *h_re, *h_im;   /* W^H x and P y */
    double *memory;
} Recursion;

static int allocate(Recursion *r, Py_ssize_t elements, Py_ssize_t columns)
{
    size_t m = (size_t)elements, k = (size_t)columns;
    size_t size = 2 * (m * k + k * k + m + 2 * k);
    double *next = calloc(size ? size : 1, sizeof(double));
    if (next == NULL)
        return -1;
    r->elements = elements;
    r->columns = columns;
    r->memory = next;
    r->basis_re = next, next += m * k;
    r->basis_im = next, next += m * k;
    r->inverse_re = next, next += k * k;
    r->inverse_im = next, next += k * k;
    r->x_re = next, next += m;
    r->x_im = next, next += m;
    r->y_re = next, next += k;
    r->y_im = next, next += k;
    r->h_re = next, next += k;
    r->h_im = next;
    return 0;
}

static void read_state(Recursion *r, const double *basis, const double *inverse)
{
    for (Py_ssize_t m = 0; m < r->elements; m++)
        for (Py_ssize_t k = 0; k < r->columns; k++) {
            r->basis_re[k * r->elements + m] = basis[2 * (m * r->columns + k)];
            r->basis_im[k * r->elements + m] = basis[2 * (m * r->columns + k) + 1];
        }
    for (Py_ssize_t i = 0; i < r->columns * r->columns; i++) {
        r->inverse_re[i] = inverse[2 * i];
        r->inverse_im[i] = inverse[2 * i + 1];
    }
}

static void write_state(const Recursion *r, double *basis, double *inverse)
{
    for (Py_ssize_t m = 0; m < r->elements; m++)
        for (Py_ssize_t k = 0; k < r->columns; k++) {
            basis[2 * (m * r->columns + k)] = r->basis_re[k * r->elements + m];
            basis[2 * (m * r->columns + k) + 1] = r->basis_im[k * r->elements + m];
        }
    for (Py_ssize_t i = 0; i < r->columns * r->columns; i++) {
        inverse[2 * i] = r->inverse_re[i];
        inverse[2 * i + 1] = r->inverse_im[i];
    }
}

static double sum(const double *lane)
{
    return (lane[0] + lane[1]) + (lane[2] + lane[3]);
}

/* y = W^H x */
static void project(Recursion *r)
{
    const Py_ssize_t n = r->elements, whole = n - n % LANES;
    for (Py_ssize_t k = 0; k < r->columns; k++) {
        const double *wr = r->basis_re + k * n, *wi = r->basis_im + k * n;
        double re[LANES] = {0.0}, im[LANES] = {0.0};
        for (Py_ssize_t m = 0; m < whole; m += LANES)
            for (int j = 0; j < LANES; j++) {
                re[j] += wr[m + j] * r->x_re[m + j] + wi[m + j] * r->x_im[m + j];
                im[j] += wr[m + j] * r->x_im[m + j] - wi[m + j] * r->x_re[m + j];
            }
        for (Py_ssize_t m = whole; m < n; m++) {
            re[m - whole] += wr[m] * r->x_re[m] + wi[m] * r->x_im[m];
            im[m - whole] += wr[m] * r->x_im[m] - wi[m] * r->x_re[m];
        }
        r->y_re[k] = sum(re);
        r->y_im[k] = sum(im);
    }
}

/* h = P y; returns Re y^H h */
static double weigh(Recursion *r)
{
    double power = 0.0;
    for (Py_ssize_t i = 0; i < r->columns; i++) {
        const double *pr = r->inverse_re + i * r->columns, *pi = r->inverse_im + i * r->columns;
        double re = 0.0, im = 0.0;
        for (Py_ssize_t k = 0; k < r->columns; k++) {
            re += pr[k] * r->y_re[k] - pi[k] * r->y_im[k];
            im += pr[k] * r->y_im[k] + pi[k] * r->y_re[k];
        }
        r->h_re[i] = re;
        r->h_im[i] = im;
        power += r->y_re[i] * re + r->y_im[i] * im;
    }
    return power;
}

/* P <- (P - share h h^H) / beta, made Hermitian */
static void update_inverse(Recursion *r, double share, double beta)
{
    const Py_ssize_t n = r->columns;
    for (Py_ssize_t i = 0; i < n; i++)
        for (Py_ssize_t k = i; k < n; k++) {
            double re = share * (r->h_re[i] * r->h_re[k] + r->h_im[i] * r->h_im[k]);
            double im = share * (r->h_im[i] * r->h_re[k] - r->h_re[i] * r->h_im[k]);
            Py_ssize_t above = i * n + k, below = k * n + i;
            re = (0.5 * (r->inverse_re[above] + r->inverse_re[below]) - re) / beta;
            im = (0.5 * (r->inverse_im[above] - r->inverse_im[below]) - im) / beta;
            r->inverse_re[above] = r->inverse_re[below] = re;
            r->inverse_im[above] = im;
            r->inverse_im[below] = 0.0 - im;
        }
}

/* x <- x - W v */
static void subtract_combination(Recursion *r, const double *v_re, const double *v_im)
{
    const Py_ssize_t n = r->elements;
    for (Py_ssize_t k = 0; k < r->columns; k++) {
        const double *wr = r->basis_re + k * n, *wi = r->basis_im + k * n;
        const double re = v_re[k], im = v_im[k];
        for (Py_ssize_t m = 0; m < n; m++) {
            r->x_re[m] -= wr[m] * re - wi[m] * im;
            r->x_im[m] -= wr[m] * im + wi[m] * re;
        }
    }
}

/* W <- W + factor x h^H */
static void update_basis(Recursion *r, double factor)
{
    const Py_ssize_t n = r->elements;
    for (Py_ssize_t k = 0; k < r->columns; k++) {
        double *wr = r->basis_re + k * n, *wi = r->basis_im + k * n;
        const double re = factor * r->h_re[k], im = factor * r->h_im[k];
        for (Py_ssize_t m = 0; m < n; m++) {
            wr[m] += r->x_re[m] * re + r->x_im[m] * im;
            wi[m] += r->x_im[m] * re - r->x_re[m] * im;
        }
    }
}

static void step(Recursion *r, double beta)
{
    project(r);
    double gain = 1.0 / (beta + weigh(r));
    update_inverse(r, gain, beta);
    subtract_combination(r, r->y_re, r->y_im);
    update_basis(r, gain);
}

static double power_of(const double *re, const double *im, Py_ssize_t n)
{
    double power = 0.0;
    for (Py_ssize_t i = 0; i < n; i++)
        power += re[i] * re[i] + im[i] * im[i];
    return power;
}

/* q = P y / beta stands in h; W is kept orthonormal. */
static void step_orthonormal(Recursion *r, double beta)
{
    project(r);
    double gamma = 1.0 / (1.0 + weigh(r) / beta);
    for (Py_ssize_t k = 0; k < r->columns; k++) {
        r->h_re[k] /= beta;
        r->h_im[k] /= beta;
    }
    /* P / beta - gamma q q^H */
    update_inverse(r, gamma * beta, beta);
    subtract_combination(r, r->y_re, r->y_im);
    for (Py_ssize_t m = 0; m < r->elements; m++) {
        r->x_re[m] *= gamma;
        r->x_im[m] *= gamma;
    }
    double q_power = power_of(r->h_re, r->h_im, r->columns);
    double p_power = power_of(r->x_re, r->x_im, r->elements);
    double root = sqrt(1.0 + p_power * q_power);
    /* (1 / sqrt(1 + ab) - 1) / a without the cancellation, and with its limit 0 at a = 0 */
    double tau = -p_power / (root * (1.0 + root));
    double along = 1.0 + tau * q_power;
    for (Py_ssize_t m = 0; m < r->elements; m++) {
        r->x_re[m] *= along;
        r->x_im[m] *= along;
    }
    for (Py_ssize_t k = 0; k < r->columns; k++) { /* p' = tau W q + along p */
        r->y_re[k] = -tau * r->h_re[k];
        r->y_im[k] = -tau * r->h_im[k];
    }
    subtract_combination(r, r->y_re, r->y_im);
    update_basis(r, 1.0);
}

static void run(Recursion *r, const double *data, Py_ssize_t snapshots, double beta, int orthonormal)
{
    for (Py_ssize_t n = 0; n < snapshots; n++, data += 2 * r->elements) {
        for (Py_ssize_t m = 0; m < r->elements; m++) {
            r->x_re[m] = data[2 * m];
            r->x_im[m] = data[2 * m + 1];
        }
        if (orthonormal)
            step_orthonormal(r, beta);
        else
            step(r, beta);
    }
}

PyDoc_STRVAR(advance_doc,
"advance(data, basis, inverse, shape, beta, orthonormal)\n--\n\n"
"Lead bases (in place) through snapshots: C-contiguous complex128, shape = (runs, snapshots,\n"
"elements, columns).");

static PyObject *advance(PyObject *module, PyObject *arguments)
{
    Py_buffer data, basis, inverse;
    Py_ssize_t runs, snapshots, elements, columns;
    double beta;
    int orthonormal;
    if (!PyArg_ParseTuple(arguments, "y*w*w*(nnnn)dp", &data, &basis, &inverse, &runs, &snapshots,
                          &elements, &columns, &beta, &orthonormal))
        return NULL;
    const Py_ssize_t pair = 2 * (Py_ssize_t)sizeof(double);
    Recursion recursion;
    int failed = 0;
    if (runs < 0 || snapshots < 0 || elements < 0 || columns < 0 ||
        data.len != runs * snapshots * elements * pair ||
        basis.len != runs * elements * columns * pair ||
        inverse.len != runs * columns * columns * pair) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
        failed = 1;
    } else if (allocate(&recursion, elements, columns) < 0) {
        PyErr_NoMemory();
        failed = 1;
    } else {
        Py_BEGIN_ALLOW_THREADS
        for (Py_ssize_t run_number = 0; run_number < runs; run_number++) {
            double *w = (double *)basis.buf + 2 * run_number * elements * columns;
            double *p = (double *)inverse.buf + 2 * run_number * columns * columns;
            read_state(&recursion, w, p);
            run(&recursion, (const double *)data.buf + 2 * run_number * snapshots * elements,
                snapshots, beta, orthonormal);
            write_state(&recursion, w, p);
        }
        free(recursion.memory);
        Py_END_ALLOW_THREADS
    }
    PyBuffer_Release(&data);
    PyBuffer_Release(&basis);
    PyBuffer_Release(&inverse);
    if (failed)
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"advance", advance, METH_VARARGS, advance_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_past", "PAST and OPAST, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_past(void)
{
    return PyModule_Create(&definition);
}
