/* What innovations say of the errors of measurements: error_models.py and error_innovations.py,
 * compiled.
 *
 * All operations are those written there in their order, and none is contracted: both give the same
 * bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>

typedef Py_ssize_t count;

enum { COLUMNS = 3, LOG = 0, PART = 1, VARIANCE = 2 };

typedef struct {
    count models;
    double wild;
    const double *lasting, *white;
} model_set;

/* One row of one run: its models after an innovation, their spreads, and what it counts */
static void learn_row(const model_set *of, const double *before, const double *phi,
                      double innovation, double own, double *after, double *spread)
{
    for (count i = 0; i < of->models; i++) {
        const double lasting = phi[i] * before[PART * of->models + i];
        const double variance =
            of->lasting[i] +
            phi[i] * phi[i] * (before[VARIANCE * of->models + i] - of->lasting[i]);
        spread[i] = variance + of->white[i] + own;
        const double left = innovation - lasting, squared = left * left / spread[i];
        const double gain = squared > of->wild ? 0.0 : variance / spread[i];
        after[LOG * of->models + i] = squared > of->wild ? of->wild : squared;
        after[PART * of->models + i] = lasting + gain * left;
        after[VARIANCE * of->models + i] = (1.0 - gain) * variance;
    }
}

/* And the log likelihoods of its models, where after has what the innovation counts */
static void weigh_row(count models, const double *before, double faded, const double *log_spread,
                      double *after)
{
    double best = -INFINITY;
    for (count i = 0; i < models; i++) {
        after[i] = faded * before[i] - 0.5 * (after[i] + log_spread[i]);
        if (after[i] > best)
            best = after[i];
    }
    for (count i = 0; i < models; i++)
        after[i] -= best;
}

PyDoc_STRVAR(learn_doc,
"learn(before, phi, place, innovation, own_variance, telling, lasting, white, after, spread, wild,\n"
"      shape)\n--\n\n"
"Take an innovation of each row in: C-contiguous float64, place int64, telling bool; shape = (rows,\n"
"models, tables of phi). Rows that do not tell stay as they are, their spreads 1.");

static PyObject *learn(PyObject *module, PyObject *arguments)
{
    Py_buffer before, phi, place, innovation, own, telling, lasting, white, after, spread;
    model_set of;
    count rows, tables;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*y*y*y*y*w*w*d(nnn)", &before, &phi, &place,
                          &innovation, &own, &telling, &lasting, &white, &after, &spread, &of.wild,
                          &rows, &of.models, &tables))
        return NULL;
    const count real = (count)sizeof(double), models = of.models, table = COLUMNS * models;
    int fits = rows >= 0 && models >= 1 && tables >= 0 && before.len == rows * table * real &&
               after.len == before.len && spread.len == rows * models * real &&
               phi.len == tables * models * real && place.len == rows * (count)sizeof(count) &&
               innovation.len == rows * real && own.len == rows * real && telling.len == rows &&
               lasting.len == models * real && white.len == models * real;
    for (count row = 0; fits && row < rows; row++)
        fits = ((count *)place.buf)[row] >= 0 && ((count *)place.buf)[row] < tables;
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    of.lasting = lasting.buf;
    of.white = white.buf;
    for (count row = 0; fits && row < rows; row++) {
        const double *had = (const double *)before.buf + row * table;
        double *has = (double *)after.buf + row * table;
        double *width = (double *)spread.buf + row * models;
        if (((const char *)telling.buf)[row]) {
            learn_row(&of, had, (const double *)phi.buf + ((count *)place.buf)[row] * models,
                      ((const double *)innovation.buf)[row], ((const double *)own.buf)[row], has,
                      width);
            continue;
        }
        for (count i = 0; i < table; i++)
            has[i] = had[i];
        for (count i = 0; i < models; i++)
            width[i] = 1.0;
    }
    Py_buffer *all[] = {&before,  &phi,     &place, &innovation, &own,
                        &telling, &lasting, &white, &after,      &spread};
    for (int i = 0; i < 10; i++)
        PyBuffer_Release(all[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

PyDoc_STRVAR(weigh_doc,
"weigh(before, faded, log_spread, telling, after, shape)\n--\n\n"
"Weigh the models of each row that tells, after they have learnt: C-contiguous float64, telling\n"
"bool, shape = (rows, models).");

static PyObject *weigh(PyObject *module, PyObject *arguments)
{
    Py_buffer before, faded, log_spread, telling, after;
    count rows, models;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*w*(nn)", &before, &faded, &log_spread, &telling,
                          &after, &rows, &models))
        return NULL;
    const count real = (count)sizeof(double), table = COLUMNS * models;
    const int fits = rows >= 0 && models >= 1 && before.len == rows * table * real &&
                     after.len == before.len && faded.len == rows * real &&
                     log_spread.len == rows * models * real && telling.len == rows;
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    for (count row = 0; fits && row < rows; row++)
        if (((const char *)telling.buf)[row])
            weigh_row(models, (const double *)before.buf + row * table,
                      ((const double *)faded.buf)[row],
                      (const double *)log_spread.buf + row * models,
                      (double *)after.buf + row * table);
    Py_buffer *all[] = {&before, &faded, &log_spread, &telling, &after};
    for (int i = 0; i < 5; i++)
        PyBuffer_Release(all[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"learn", learn, METH_VARARGS, learn_doc},
    {"weigh", weigh, METH_VARARGS, weigh_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_errors", "What innovations say of errors, compiled.", -1,
    methods, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_errors(void)
{
    return PyModule_Create(&definition);
}
