/* Motion modes of many tracks, mixed and moved: mode_prediction.py, compiled.
 *
 * All operations are those of mode_prediction.py in their order, and none is contracted: both give
 * the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#define SIZE 4    /* x, y, vx, vy */
#define SQUARE 16 /* entries of a covariance */

/* Modes of one track mixed into one mode, with these weights */
static void mix_into(const double *weight, const double *means, const double *covariances,
                     Py_ssize_t n_modes, double *mean, double *covariance)
{
    for (int a = 0; a < SIZE; a++)
        mean[a] = weight[0] * means[a];
    for (Py_ssize_t mode = 1; mode < n_modes; mode++)
        for (int a = 0; a < SIZE; a++)
            mean[a] += weight[mode] * means[SIZE * mode + a];
    for (Py_ssize_t mode = 0; mode < n_modes; mode++) {
        const double *own = covariances + SQUARE * mode, share = weight[mode];
        double away[SIZE];
        for (int a = 0; a < SIZE; a++)
            away[a] = means[SIZE * mode + a] - mean[a];
        for (int a = 0; a < SIZE; a++)
            for (int b = 0; b < SIZE; b++) {
                double term = (away[a] * away[b] + own[SIZE * a + b]) * share;
                double *entry = covariance + SIZE * a + b;
                *entry = mode ? *entry + term : term;
            }
    }
}

/* x <- x + B v, v <- D v */
static void move_mean(const double *f, const double *mean, double *moved)
{
    const double u = mean[2], v = mean[3];
    moved[0] = mean[0] + (f[2] * u + f[3] * v);
    moved[1] = mean[1] + (f[6] * u + f[7] * v);
    moved[2] = f[10] * u + f[11] * v;
    moved[3] = f[14] * u + f[15] * v;
}

/* F S F^T with F = [I B; 0 D], S = [A P; P^T V] */
static void move_covariance(const double *f, const double *s, double *moved)
{
    const double b00 = f[2], b01 = f[3], b10 = f[6], b11 = f[7];
    const double d00 = f[10], d01 = f[11], d10 = f[14], d11 = f[15];
    const double p00 = s[2], p01 = s[3], p10 = s[6], p11 = s[7];
    const double v00 = s[10], v01 = s[11], v11 = s[15];
    /* X = P + B V */
    const double x00 = p00 + (b00 * v00 + b01 * v01), x01 = p01 + (b00 * v01 + b01 * v11);
    const double x10 = p10 + (b10 * v00 + b11 * v01), x11 = p11 + (b10 * v01 + b11 * v11);
    /* A + X B^T + B P^T */
    moved[0] = s[0] + ((x00 * b00 + x01 * b01) + (b00 * p00 + b01 * p01));
    moved[1] = moved[4] = s[1] + ((x00 * b10 + x01 * b11) + (b00 * p10 + b01 * p11));
    moved[5] = s[5] + ((x10 * b10 + x11 * b11) + (b10 * p10 + b11 * p11));
    /* X D^T */
    moved[2] = moved[8] = x00 * d00 + x01 * d01;
    moved[3] = moved[12] = x00 * d10 + x01 * d11;
    moved[6] = moved[9] = x10 * d00 + x11 * d01;
    moved[7] = moved[13] = x10 * d10 + x11 * d11;
    /* D V D^T */
    const double z00 = d00 * v00 + d01 * v01, z01 = d00 * v01 + d01 * v11;
    const double z10 = d10 * v00 + d11 * v01, z11 = d10 * v01 + d11 * v11;
    moved[10] = z00 * d00 + z01 * d01;
    moved[11] = moved[14] = z00 * d10 + z01 * d11;
    moved[15] = z10 * d10 + z11 * d11;
}

static int all_have(const Py_buffer *buffer, const Py_ssize_t *sizes, int count)
{
    for (int i = 0; i < count; i++)
        if (sizes[i] < 0 || buffer[i].len != sizes[i] * (Py_ssize_t)sizeof(double)) {
            PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
            return 0;
        }
    return 1;
}

static PyObject *released(Py_buffer *buffer, int count)
{
    for (int i = 0; i < count; i++)
        PyBuffer_Release(&buffer[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

PyDoc_STRVAR(mix_doc,
"mix(weight, mean, covariance, mixed_mean, mixed_covariance, shape)\n--\n\n"
"Mix the modes of tracks into the last two: C-contiguous float64, shape = (tracks, modes).");

static PyObject *mix(PyObject *module, PyObject *arguments)
{
    Py_buffer b[5];
    Py_ssize_t n, m;
    if (!PyArg_ParseTuple(arguments, "y*y*y*w*w*(nn)", &b[0], &b[1], &b[2], &b[3], &b[4], &n, &m))
        return NULL;
    const Py_ssize_t sizes[5] = {n * m * m, SIZE * n * m, SQUARE * n * m, SIZE * n * m,
                                 SQUARE * n * m};
    if (all_have(b, sizes, 5)) {
        Py_BEGIN_ALLOW_THREADS
        for (Py_ssize_t track = 0; track < n; track++)
            for (Py_ssize_t mode = track * m; mode < (track + 1) * m; mode++)
                mix_into((const double *)b[0].buf + m * mode,
                         (const double *)b[1].buf + SIZE * m * track,
                         (const double *)b[2].buf + SQUARE * m * track, m,
                         (double *)b[3].buf + SIZE * mode, (double *)b[4].buf + SQUARE * mode);
        Py_END_ALLOW_THREADS
    }
    return released(b, 5);
}

PyDoc_STRVAR(move_doc,
"move(matrices, mean, covariance, moved_mean, moved_covariance, shape)\n--\n\n"
"Move states and covariances by matrices [I B; 0 D] into the last two: C-contiguous float64,\n"
"shape = (states, matrices); the states take the matrices by turns.");

static PyObject *move(PyObject *module, PyObject *arguments)
{
    Py_buffer b[5];
    Py_ssize_t n, m;
    if (!PyArg_ParseTuple(arguments, "y*y*y*w*w*(nn)", &b[0], &b[1], &b[2], &b[3], &b[4], &n, &m))
        return NULL;
    const Py_ssize_t sizes[5] = {SQUARE * m, SIZE * n, SQUARE * n, SIZE * n, SQUARE * n};
    if (n > 0 && m < 1)
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    else if (all_have(b, sizes, 5)) {
        Py_BEGIN_ALLOW_THREADS
        for (Py_ssize_t state = 0, own = 0; state < n; state++, own = own + 1 < m ? own + 1 : 0) {
            const double *f = (const double *)b[0].buf + SQUARE * own;
            move_mean(f, (const double *)b[1].buf + SIZE * state,
                      (double *)b[3].buf + SIZE * state);
            move_covariance(f, (const double *)b[2].buf + SQUARE * state,
                            (double *)b[4].buf + SQUARE * state);
        }
        Py_END_ALLOW_THREADS
    }
    return released(b, 5);
}

static PyMethodDef methods[] = {
    {"mix", mix, METH_VARARGS, mix_doc},
    {"move", move, METH_VARARGS, move_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_modes", "Motion modes, mixed and moved, compiled.", -1,
    methods, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_modes(void)
{
    return PyModule_Create(&definition);
}
