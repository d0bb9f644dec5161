/* Band-limited noise between the points of its grid: broadband_waveform.py, compiled.
 *
 * In numpy all windows of the grid and of the kernel are gathered before they are multiplied. All
 * operations are those of broadband_waveform.py in their order, and none is contracted: both give
 * the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>

enum { TOGETHER = 4 }; /* sums that do not wait for one another */

typedef struct {
    const double *grid, *table;
    Py_ssize_t first, taps, phases; /* index of the grid's first point, width and phases of table */
} kernel;

/* Returns whether the window of a time lies in the grid */
static int place(const kernel *all, Py_ssize_t points, double step, const double **window,
                 const double **weight)
{
    const double whole = floor(step);
    const double begin = whole + 1.0 - (double)(all->taps / 2) - (double)all->first;
    if (!(begin >= 0.0 && begin + (double)all->taps <= (double)points))
        return 0;
    *window = all->grid + (Py_ssize_t)begin;
    *weight = all->table + (Py_ssize_t)rint((step - whole) * (double)all->phases) * all->taps;
    return 1;
}

static int interpolate_all(const kernel *all, Py_ssize_t points, const double *steps,
                           Py_ssize_t times, double *out)
{
    const double *window[TOGETHER], *weight[TOGETHER];
    for (Py_ssize_t time = 0; time < times; time += TOGETHER) {
        const int own = times - time < TOGETHER ? (int)(times - time) : TOGETHER;
        double sum[TOGETHER];
        for (int i = 0; i < TOGETHER; i++) /* the last ones may be there more than once */
            if (!place(all, points, steps[time + (i < own ? i : 0)], &window[i], &weight[i]))
                return 0;
        for (int i = 0; i < TOGETHER; i++)
            sum[i] = window[i][0] * weight[i][0];
        for (Py_ssize_t k = 1; k < all->taps; k++)
            for (int i = 0; i < TOGETHER; i++)
                sum[i] += window[i][k] * weight[i][k];
        for (int i = 0; i < own; i++)
            out[time + i] = sum[i];
    }
    return 1;
}

PyDoc_STRVAR(interpolate_doc,
"interpolate(grid, table, steps, out, (first, phases, taps))\n--\n\n"
"Interpolate: C-contiguous float64; steps and out, shape (times,), in steps of the grid, whose\n"
"first point is step number first; table, shape (phases + 1, taps); last argument (first, phases, taps).");

static PyObject *interpolate(PyObject *module, PyObject *arguments)
{
    Py_buffer grid, table, steps, out;
    kernel all;
    if (!PyArg_ParseTuple(arguments, "y*y*y*w*(nnn)", &grid, &table, &steps, &out, &all.first,
                          &all.phases, &all.taps))
        return NULL;
    const Py_ssize_t size = (Py_ssize_t)sizeof(double);
    int fits = all.taps > 1 && all.phases > 0 &&
               table.len == (all.phases + 1) * all.taps * size && steps.len == out.len;
    if (fits) {
        all.grid = grid.buf;
        all.table = table.buf;
        Py_BEGIN_ALLOW_THREADS
        fits = interpolate_all(&all, grid.len / size, steps.buf, steps.len / size, out.buf);
        Py_END_ALLOW_THREADS
    }
    PyBuffer_Release(&grid);
    PyBuffer_Release(&table);
    PyBuffer_Release(&steps);
    PyBuffer_Release(&out);
    if (!fits) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape, or times "
                                          "are outside of the grid.");
        return NULL;
    }
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"interpolate", interpolate, METH_VARARGS, interpolate_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_waveform", "Noise between grid points, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_waveform(void)
{
    return PyModule_Create(&definition);
}
