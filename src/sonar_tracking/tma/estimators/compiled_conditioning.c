/* Rows taken into a bank of Kalman filters: conditioning.py, compiled.
 *
 * All operations are those of conditioning.py in their order, and none is contracted: both give
 * the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>

typedef Py_ssize_t count;

typedef struct {
    count n, size, rows, used;
    const count *taken; /* places of the rows that any component has */
} sizes;

/* One component; cross has room for n numbers */
static void condition_one(const sizes *of, int whole, const double *derivative,
                          const double *innovation, const double *variance, double *covariance,
                          double *shift, double *squared, double *spreads, count stride,
                          double *cross)
{
    const count n = of->n, size = of->size, length = whole ? n : size;
    double total = 0.0;
    for (count entry = 0; entry < of->used; entry++) {
        const count row = of->taken[entry];
        const double *own = derivative + row * size;
        for (count i = 0; i < length; i++) {
            double sum = covariance[i * n] * own[0];
            for (count k = 1; k < size; k++)
                sum += covariance[i * n + k] * own[k];
            cross[i] = sum;
        }
        double spread = own[0] * cross[0], seen = own[0] * shift[0];
        for (count k = 1; k < size; k++) {
            spread += own[k] * cross[k];
            seen += own[k] * shift[k];
        }
        spread += variance[row];
        const double root = sqrt(spread), left = innovation[row] - seen, step = left / root;
        for (count i = 0; i < length; i++) {
            cross[i] /= root;
            shift[i] += cross[i] * step;
        }
        for (count i = 0; i < length; i++)
            for (count j = 0; j < length; j++)
                covariance[i * n + j] -= cross[i] * cross[j];
        total += left * left / spread;
        spreads[entry * stride] = spread;
    }
    *squared = total;
}

PyDoc_STRVAR(condition_doc,
"condition(covariance, derivative, innovation, variance, taken, whole, shift, squared, spreads,\n"
"          shape)\n--\n\n"
"Condition states on rows, in place: C-contiguous float64, taken and whole int64, shape =\n"
"(components, states, states that rows depend on, rows); whole says of each component whether\n"
"the states that no row depends on are taken along.");

static PyObject *condition(PyObject *module, PyObject *arguments)
{
    Py_buffer covariance, derivative, innovation, variance, taken, whole, shift, squared, spreads;
    count components;
    sizes of;
    if (!PyArg_ParseTuple(arguments, "w*y*y*y*y*y*w*w*w*(nnnn)", &covariance, &derivative,
                          &innovation, &variance, &taken, &whole, &shift, &squared, &spreads,
                          &components, &of.n, &of.size, &of.rows))
        return NULL;
    const count real = (count)sizeof(double);
    of.used = taken.len / (count)sizeof(count);
    of.taken = taken.buf;
    int fits = components >= 0 && of.size >= 1 && of.n >= of.size && of.rows >= 0 &&
               covariance.len == components * of.n * of.n * real &&
               derivative.len == components * of.rows * of.size * real &&
               innovation.len == components * of.rows * real &&
               variance.len == components * of.rows * real &&
               whole.len == components * (count)sizeof(count) &&
               shift.len == components * of.n * real && squared.len == components * real &&
               spreads.len == of.used * components * real;
    for (count entry = 0; fits && entry < of.used; entry++)
        fits = of.taken[entry] >= 0 && of.taken[entry] < of.rows;
    if (!fits) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else {
        double *cross = malloc((size_t)(of.n * real));
        if (cross == NULL) {
            PyErr_NoMemory();
        } else {
            Py_BEGIN_ALLOW_THREADS
            for (count i = 0; i < components; i++)
                condition_one(&of, ((const count *)whole.buf)[i] != 0,
                              (const double *)derivative.buf + i * of.rows * of.size,
                              (const double *)innovation.buf + i * of.rows,
                              (const double *)variance.buf + i * of.rows,
                              (double *)covariance.buf + i * of.n * of.n,
                              (double *)shift.buf + i * of.n, (double *)squared.buf + i,
                              (double *)spreads.buf + i, components, cross);
            Py_END_ALLOW_THREADS
            free(cross);
        }
    }
    Py_buffer *all[] = {&covariance, &derivative, &innovation, &variance, &taken,
                        &whole,      &shift,      &squared,    &spreads};
    for (int i = 0; i < 9; i++)
        PyBuffer_Release(all[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"condition", condition, METH_VARARGS, condition_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_conditioning", "Rows taken into a bank, compiled.", -1,
    methods, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_conditioning(void)
{
    return PyModule_Create(&definition);
}
