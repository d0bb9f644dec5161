/* Rows taken into a bank of Kalman filters: conditioning.py, compiled.
 *
 * All operations are those of conditioning.py in their order, and none is contracted: both give
 * the same bits. Several components are computed side by side.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>

typedef Py_ssize_t count;

/* Wider registers where the processor has them: the same operations, and the same bits */
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__)
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif
#define INLINE static inline __attribute__((always_inline))

enum { LANES = 4 };
#define EACH for (count lane = 0; lane < LANES; lane++)

/* One number of each of several components */
typedef double lanes __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(double))));

typedef struct {
    count components, n, size, rows, used;
    const count *taken; /* places of the rows that any component has */
    const double *derivative, *innovation, *variance;
    double *covariance, *shift, *squared, *spreads;
} bank;

/* A number of each component, of arrays of so many numbers a component */
INLINE lanes number_of(const double *values, const count *which, count width, count place)
{
    values += place;
    return (lanes){values[which[0] * width], values[which[1] * width], values[which[2] * width],
                   values[which[3] * width]};
}

INLINE void set_number(double *values, const count *which, count width, count place, lanes number)
{
    EACH values[which[lane] * width + place] = number[lane];
}

INLINE int is_zero(lanes number)
{
    int found = 0;
    EACH found |= number[lane] != 0.0;
    return !found;
}

/* Components side by side, with states of a length; room for (length + 3) length numbers of each.
 * What no row of any of them depends on adds nothing. */
WIDE static void condition_some(const bank *of, const count *which, count length, lanes *room)
{
    const count n = of->n, size = of->size;
    lanes *restrict cross = room, *restrict shift = room + length;
    lanes *restrict own = room + 2 * length;
    lanes *restrict states = room + 3 * length, total = {0.0};
    for (count i = 0; i < length; i++) {
        shift[i] = (lanes){0.0};
        for (count k = 0; k < length; k++)
            states[i * length + k] = number_of(of->covariance, which, n * n, i * n + k);
    }
    for (count entry = 0; entry < of->used; entry++) {
        const count row = of->taken[entry];
        for (count i = 0; i < length; i++)
            cross[i] = (lanes){0.0};
        for (count k = 0; k < size; k++) {
            own[k] = number_of(of->derivative, which, of->rows * size, row * size + k);
            if (is_zero(own[k]))
                continue;
            for (count i = 0; i < length; i++)
                cross[i] += states[i * length + k] * own[k];
        }
        lanes spread = own[0] * cross[0], seen = own[0] * shift[0], root;
        for (count k = 1; k < size; k++) {
            spread += own[k] * cross[k];
            seen += own[k] * shift[k];
        }
        spread += number_of(of->variance, which, of->rows, row);
        EACH root[lane] = sqrt(spread[lane]);
        const lanes left = number_of(of->innovation, which, of->rows, row) - seen;
        const lanes step = left / root;
        for (count i = 0; i < length; i++) {
            cross[i] /= root;
            shift[i] += cross[i] * step;
        }
        for (count i = 0; i < length; i++)
            for (count j = 0; j < length; j++)
                states[i * length + j] -= cross[i] * cross[j];
        total += left * left / spread;
        set_number(of->spreads + entry * of->components, which, 1, 0, spread);
    }
    for (count i = 0; i < length; i++) {
        set_number(of->shift, which, n, i, shift[i]);
        for (count k = 0; k < length; k++)
            set_number(of->covariance, which, n * n, i * n + k, states[i * length + k]);
    }
    set_number(of->squared, which, 1, 0, total);
}

/* All components whose states of the last kind are taken along, or all others */
static void condition_all(const bank *of, const count *whole, int along, lanes *room)
{
    const count length = along ? of->n : of->size;
    count which[LANES], found = 0;
    for (count i = 0; i < of->components; i++) {
        if ((whole[i] != 0) != along)
            continue;
        which[found++] = i;
        if (found == LANES) {
            condition_some(of, which, length, room);
            found = 0;
        }
    }
    if (found == 0)
        return;
    for (count lane = found; lane < LANES; lane++)
        which[lane] = which[0]; /* computed several times, and the same each time */
    condition_some(of, which, length, room);
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
    bank of;
    if (!PyArg_ParseTuple(arguments, "w*y*y*y*y*y*w*w*w*(nnnn)", &covariance, &derivative,
                          &innovation, &variance, &taken, &whole, &shift, &squared, &spreads,
                          &of.components, &of.n, &of.size, &of.rows))
        return NULL;
    const count real = (count)sizeof(double), components = of.components;
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
        lanes *room = malloc((size_t)((of.n + 3) * of.n) * sizeof(lanes));
        if (room == NULL) {
            PyErr_NoMemory();
        } else {
            of.derivative = derivative.buf, of.innovation = innovation.buf;
            of.variance = variance.buf, of.covariance = covariance.buf, of.shift = shift.buf;
            of.squared = squared.buf, of.spreads = spreads.buf;
            Py_BEGIN_ALLOW_THREADS
            condition_all(&of, whole.buf, 0, room);
            condition_all(&of, whole.buf, 1, room);
            Py_END_ALLOW_THREADS
            free(room);
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
