/* Innovations of a bank averaged over its hypotheses: error_innovations.py, compiled.
 *
 * All operations are those written there in their order, and none is contracted: both give the same
 * bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef Py_ssize_t count;

enum { ELEVATION = 1 };

typedef struct {
    count lines, compared;
    double vague;
} limits;

/* What hypotheses have, row by row: 2 + n_lines of each */
typedef struct {
    const double *weight, *innovation, *variance, *told;
    const char *present;
} bank;

/* Mean and spread of one row of a run over its hypotheses, from first to last */
static void average_row(const bank *of, count first, count last, count width, count row,
                        double *mean, double *own, char *present)
{
    *mean = *own = 0.0;
    *present = 0;
    for (count i = first; i < last; i++) {
        *mean += of->weight[i] * of->innovation[i * width + row];
        *present |= of->present[i * width + row] != 0;
    }
    for (count i = first; i < last; i++) {
        const count place = i * width + row;
        const double apart = of->innovation[place] - *mean;
        *own += of->weight[i] * ((of->variance[place] - of->told[place]) + apart * apart);
    }
}

/* Each line compared with the others, if there are enough; room for 4 n_lines */
static void remove_doppler(const limits *of, const double *frequency, const double *told,
                           const char *present, double *mean, double *own, double *room)
{
    const count n = of->lines;
    double *scale = room, *weight = room + n, *shift = room + 2 * n, weights = 0.0, shifts = 0.0;
    count there = 0;
    for (count i = 0; i < n; i++) {
        scale[i] = present[i] ? frequency[i] : 1.0;
        weight[i] = present[i] ? scale[i] * scale[i] / told[i] : 0.0;
        shift[i] = weight[i] * (present[i] ? mean[i] : 0.0) / scale[i];
        weights = i ? weights + weight[i] : weight[i];
        shifts = i ? shifts + shift[i] : shift[i];
        there += present[i] != 0;
    }
    for (count i = 0; i < n && there >= of->compared; i++) {
        if (!present[i])
            continue;
        const double others = weights - weight[i], common = (shifts - shift[i]) / others;
        mean[i] -= scale[i] * common;
        own[i] = scale[i] * scale[i] / others;
    }
}

/* One run; room for 5 (1 + n_lines) */
static void average_run(const limits *of, const bank *all, count first, count last,
                        const double *factor, const double *frequency, char azimuth_usable,
                        const char *lines_usable, double *mean, double *own, char *telling,
                        double *room)
{
    const count n = of->lines, width = 2 + n;
    double *told = room;
    for (count column = 0; column <= n; column++) {
        const count row = column ? ELEVATION + column : 0;
        average_row(all, first, last, width, row, mean + column, own + column, telling + column);
        told[column] = telling[column] ? all->told[first * width + row] / factor[column] : 1.0;
        if (column)
            telling[column] = telling[column] && lines_usable[column - 1];
    }
    if (n)
        remove_doppler(of, frequency, told + 1, telling + 1, mean + 1, own + 1, room + 1 + n);
    for (count column = 0; column <= n; column++) {
        own[column] /= told[column];
        mean[column] /= sqrt(told[column]);
        telling[column] = telling[column] && own[column] < of->vague * factor[column];
    }
    telling[0] = telling[0] && azimuth_usable;
}

PyDoc_STRVAR(average_doc,
"average(weight, innovation, variance, told, present, counts, factor, frequency, azimuth_usable,\n"
"        lines_usable, mean, own, telling, limits, shape)\n--\n\n"
"Average innovations over the hypotheses of runs: C-contiguous float64, counts int64, present,\n"
"usable and telling bool; limits = (variance beyond which nothing is told, lines that are\n"
"compared), shape = (runs, hypotheses, lines).");

static PyObject *average(PyObject *module, PyObject *arguments)
{
    Py_buffer weight, innovation, variance, told, present, counts, factor, frequency;
    Py_buffer azimuth_usable, lines_usable, mean, own, telling;
    count runs, hypotheses;
    limits of;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*y*y*y*y*y*y*w*w*w*(dn)(nnn)", &weight, &innovation,
                          &variance, &told, &present, &counts, &factor, &frequency,
                          &azimuth_usable, &lines_usable, &mean, &own, &telling, &of.vague,
                          &of.compared, &runs, &hypotheses, &of.lines))
        return NULL;
    const count real = (count)sizeof(double), n = of.lines, entries = hypotheses * (2 + n);
    int fits = runs >= 0 && hypotheses >= 0 && n >= 0 && weight.len == hypotheses * real &&
               innovation.len == entries * real && variance.len == entries * real &&
               told.len == entries * real && present.len == entries &&
               counts.len == runs * (count)sizeof(count) && factor.len == runs * (1 + n) * real &&
               frequency.len == runs * n * real && azimuth_usable.len == runs &&
               lines_usable.len == runs * n && mean.len == factor.len && own.len == factor.len &&
               telling.len == runs * (1 + n);
    count left = hypotheses;
    for (count run = 0; fits && run < runs; run++) {
        const count members = ((const count *)counts.buf)[run];
        fits = members >= 1 && members <= left;
        left -= members;
    }
    double *room = NULL;
    if (!fits || left != 0)
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    else if ((room = malloc((size_t)(5 * (1 + n) * real))) == NULL)
        PyErr_NoMemory();
    const bank all = {weight.buf, innovation.buf, variance.buf, told.buf, present.buf};
    for (count run = 0, first = 0; room != NULL && run < runs; run++) {
        const count last = first + ((const count *)counts.buf)[run], place = run * (1 + n);
        average_run(&of, &all, first, last, (const double *)factor.buf + place,
                    (const double *)frequency.buf + run * n, ((const char *)azimuth_usable.buf)[run],
                    (const char *)lines_usable.buf + run * n, (double *)mean.buf + place,
                    (double *)own.buf + place, (char *)telling.buf + place, room);
        first = last;
    }
    free(room);
    Py_buffer *every[] = {&weight,    &innovation,     &variance,     &told, &present, &counts, &factor,
                          &frequency, &azimuth_usable, &lines_usable, &mean, &own,     &telling};
    for (int i = 0; i < 13; i++)
        PyBuffer_Release(every[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"average", average, METH_VARARGS, average_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_innovations", "Innovations of a bank averaged, compiled.", -1,
    methods, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_innovations(void)
{
    return PyModule_Create(&definition);
}
