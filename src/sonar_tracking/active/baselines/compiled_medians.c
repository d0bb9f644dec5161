/* Weighted medians of the particles of clusters: weighted_medians.py, compiled.
 *
 * Found by selection instead of sorting. Where so much of the weight lies on either side that the
 * order of a sum could decide, they are sorted as in weighted_medians.py: both give the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>

#define SIZE 4 /* x, y, vx, vy */
#define FEW 16 /* so many are sorted */
#define ROUNDING 1e-9 /* more than that of a sum, relative */

typedef long long Row; /* numpy's int64 */

typedef struct {
    double value, weight;
} Particle;

static double middle_of(double a, double b, double c)
{
    const double low = a < b ? a : b, high = a < b ? b : a;
    return c < low ? low : c > high ? high : c;
}

static int by_value(const void *one, const void *other)
{
    const double a = ((const Particle *)one)->value, b = ((const Particle *)other)->value;
    return (a > b) - (a < b);
}

static void sort_few(Particle *p, Py_ssize_t n)
{
    for (Py_ssize_t i = 1; i < n; i++) {
        const Particle one = p[i];
        Py_ssize_t j = i;
        for (; j > 0 && p[j - 1].value > one.value; j--)
            p[j] = p[j - 1];
        p[j] = one;
    }
}

/* Find the smallest value up to which half of the weight lies, those on one side of a value left
 * out again and again. Needs room for as many; returns whether rounding cannot have decided. */
static int select_median(Particle *p, Particle *other, Py_ssize_t n, double total, double *median)
{
    const double half = 0.5 * total, near = ROUNDING * total;
    double left_out = 0.0;
    while (n > FEW) {
        const double pivot = middle_of(p[0].value, p[n / 2].value, p[n - 1].value);
        Py_ssize_t below = 0, above = 0;
        double sum = left_out, equal = 0.0;
        for (Py_ssize_t i = 0; i < n; i++) {
            const Particle one = p[i];
            const int less = one.value < pivot, more = one.value > pivot;
            p[below] = one;
            other[above] = one;
            below += less;
            above += more;
            sum += less ? one.weight : 0.0;
            equal += less | more ? 0.0 : one.weight;
        }
        if (!(fabs(sum - half) > near && fabs(sum + equal - half) > near))
            return 0;
        if (sum > half) {
            n = below;
            continue;
        }
        *median = pivot;
        if (sum + equal > half)
            return 1;
        left_out = sum + equal;
        n = above;
        Particle *swapped = p;
        p = other;
        other = swapped;
    }
    sort_few(p, n);
    for (Py_ssize_t i = 0; i < n; i++) {
        left_out += p[i].weight;
        *median = p[i].value;
        if (!(fabs(left_out - half) > near))
            return 0;
        if (left_out > half)
            return 1;
    }
    return 0;
}

/* The same, all sorted and summed in their order. Writes the sums to a column of as many. */
static double sorted_median(Particle *p, double *edges, Py_ssize_t n)
{
    double sum = 0.0;
    qsort(p, (size_t)n, sizeof(Particle), by_value);
    for (Py_ssize_t i = 0; i < n; i++)
        edges[i] = sum += p[i].weight;
    Py_ssize_t middle = 0;
    while (middle + 1 < n && edges[middle] < 0.5 * sum)
        middle++;
    return p[middle].value;
}

PyDoc_STRVAR(medians_doc,
"medians(state, weight, counts, medians)\n--\n\n"
"Write the weighted median of each of four columns in each stretch of rows: C-contiguous float64\n"
"and int64; weights are not negative and counts above 0.");

static const char *wrong(const Py_buffer *b)
{
    const Py_ssize_t n = b[1].len / 8, stretches = b[2].len / 8;
    const Row *counts = b[2].buf;
    Row sum = 0;
    if (b[1].len % 8 || b[2].len % 8 || b[0].len != 8 * SIZE * n ||
        b[3].len != 8 * SIZE * stretches)
        return "The buffers do not have the stated shape.";
    for (Py_ssize_t i = 0; i < stretches; i++) {
        if (counts[i] < 1 || counts[i] > (Row)n - sum)
            return "The counts are not those of the rows.";
        sum += counts[i];
    }
    return NULL;
}

static void find_all(const Py_buffer *b, Particle *particles, Py_ssize_t room)
{
    const double *state = b[0].buf, *weight = b[1].buf;
    const Row *counts = b[2].buf;
    double *median = b[3].buf;
    for (Py_ssize_t stretch = 0; stretch < b[2].len / 8; stretch++) {
        const Py_ssize_t n = (Py_ssize_t)counts[stretch];
        double total = 0.0;
        for (Py_ssize_t i = 0; i < n; i++)
            total += weight[i];
        for (int axis = 0; axis < SIZE; axis++, median++)
            for (int exact = 0; exact < 2; exact++) {
                for (Py_ssize_t i = 0; i < n; i++)
                    particles[i] = (Particle){state[SIZE * i + axis], weight[i]};
                if (exact)
                    *median = sorted_median(particles, (double *)(particles + room), n);
                else if (select_median(particles, particles + room, n, total, median))
                    break;
            }
        state += SIZE * n;
        weight += n;
    }
}

static PyObject *medians(PyObject *module, PyObject *arguments)
{
    Py_buffer b[4];
    if (!PyArg_ParseTuple(arguments, "y*y*y*w*", &b[0], &b[1], &b[2], &b[3]))
        return NULL;
    const char *error = wrong(b);
    const Py_ssize_t room = b[1].len / 8;
    Particle *particles = error ? NULL : malloc(2 * ((size_t)room + 1) * sizeof(Particle));
    if (error != NULL) {
        PyErr_SetString(PyExc_ValueError, error);
    } else if (particles == NULL) {
        PyErr_NoMemory();
    } else {
        Py_BEGIN_ALLOW_THREADS
        find_all(b, particles, room);
        Py_END_ALLOW_THREADS
    }
    free(particles);
    for (int i = 0; i < 4; i++)
        PyBuffer_Release(&b[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"medians", medians, METH_VARARGS, medians_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_medians", "Weighted medians, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_medians(void)
{
    return PyModule_Create(&definition);
}
