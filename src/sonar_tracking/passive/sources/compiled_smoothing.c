/* Spatial smoothing of covariances: spatial_smoothing.py, compiled.
 *
 * All operations are those of spatial_smoothing.py in their order, and none is contracted: both
 * give the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <stdlib.h>
#include <string.h>

/* Sums along the diagonals from the upper and the left edge, complex numbers one after the other */
static void sum_diagonals(double *running, Py_ssize_t n)
{
    for (Py_ssize_t row = 1; row < n; row++) {
        const double *above = running + 2 * n * (row - 1);
        double *own = running + 2 * n * row + 2;
        for (Py_ssize_t i = 0; i < 2 * (n - 1); i++)
            own[i] += above[i];
    }
}

/* Mean over the sub-arrays: differences of two of these sums */
static void average(const double *running, Py_ssize_t n, Py_ssize_t size, double *mean)
{
    const Py_ssize_t arrays = n - size + 1;
    const double share = 1.0 / (double)arrays;
    for (Py_ssize_t row = 0; row < size; row++)
        for (Py_ssize_t column = 0; column < size; column++) {
            const double *end = running + 2 * (n * (row + arrays - 1) + column + arrays - 1);
            double re = end[0], im = end[1];
            if (row > 0 && column > 0) {
                const double *begin = running + 2 * (n * (row - 1) + column - 1);
                re -= begin[0];
                im -= begin[1];
            }
            mean[2 * (size * row + column)] = (re + im * 0.0) * share;
            mean[2 * (size * row + column) + 1] = (im - re * 0.0) * share;
        }
}

/* (C + J conj(C) J) / 2 */
static void add_backward(const double *mean, Py_ssize_t size, double *smoothed)
{
    const Py_ssize_t last = size * size - 1;
    for (Py_ssize_t i = 0; i <= last; i++) {
        const double re = mean[2 * i] + mean[2 * (last - i)];
        const double im = mean[2 * i + 1] - mean[2 * (last - i) + 1];
        smoothed[2 * i] = 0.5 * re - 0.0 * im;
        smoothed[2 * i + 1] = 0.5 * im + 0.0 * re;
    }
}

PyDoc_STRVAR(smooth_doc,
"smooth(covariance, smoothed, shape)\n--\n\n"
"Smooth covariances into the second: C-contiguous complex128, shape = (matrices, elements,\n"
"elements of a sub-array).");

static PyObject *smooth(PyObject *module, PyObject *arguments)
{
    Py_buffer covariance, smoothed;
    Py_ssize_t matrices, n, size;
    if (!PyArg_ParseTuple(arguments, "y*w*(nnn)", &covariance, &smoothed, &matrices, &n, &size))
        return NULL;
    const Py_ssize_t pair = 2 * (Py_ssize_t)sizeof(double);
    if (matrices < 0 || size < 1 || n < size || covariance.len != matrices * n * n * pair ||
        smoothed.len != matrices * size * size * pair) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else {
        double *running = malloc((size_t)(n * n + size * size) * (size_t)pair);
        if (running == NULL) {
            PyErr_NoMemory();
        } else {
            double *mean = running + 2 * n * n;
            Py_BEGIN_ALLOW_THREADS
            for (Py_ssize_t i = 0; i < matrices; i++) {
                memcpy(running, (const double *)covariance.buf + 2 * n * n * i,
                       (size_t)(n * n) * (size_t)pair);
                sum_diagonals(running, n);
                average(running, n, size, mean);
                add_backward(mean, size, (double *)smoothed.buf + 2 * size * size * i);
            }
            Py_END_ALLOW_THREADS
            free(running);
        }
    }
    PyBuffer_Release(&covariance);
    PyBuffer_Release(&smoothed);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"smooth", smooth, METH_VARARGS, smooth_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_smoothing", "Spatial smoothing, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_smoothing(void)
{
    return PyModule_Create(&definition);
}
