/* Clouds of particles: cloud_steps.py, compiled.
 *
 * All operations are those of cloud_steps.py in their order, and none is contracted: both give the
 * same bits. Sines and cosines are those of numpy.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>

#define SIZE 4   /* x, y, vx, vy */
#define MODES 3  /* straight, left, right */
#define LARGEST_NUMBER_OF_BUFFERS 8

typedef long long Row; /* numpy's int64 */

/* Take the buffers of a tuple; sizes are in numbers of eight bytes. Returns how many are held, all
 * of them or, with an exception, fewer. */
static int take(PyObject *tuple, Py_buffer *buffer, const Py_ssize_t *sizes, int count, int written)
{
    int held = 0;
    if (PyTuple_GET_SIZE(tuple) != count) {
        PyErr_SetString(PyExc_ValueError, "The number of buffers is wrong.");
        return 0;
    }
    for (; held < count; held++) {
        int flags = held < count - written ? PyBUF_SIMPLE : PyBUF_WRITABLE;
        if (PyObject_GetBuffer(PyTuple_GET_ITEM(tuple, held), &buffer[held], flags) < 0)
            return held;
        if (sizes[held] < 0 || buffer[held].len != 8 * sizes[held]) {
            PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
            return held + 1;
        }
    }
    return held;
}

static PyObject *released(Py_buffer *buffer, int held)
{
    while (held-- > 0)
        PyBuffer_Release(&buffer[held]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static void begin_turns(Py_ssize_t n, const double *state, const Row *mode, const Row *other,
                        const double *lateral, double smallest_speed, double half_interval,
                        Row *next_mode, double *half)
{
    for (Py_ssize_t i = 0; i < n; i++) {
        const Row next = mode[i] + other[i];
        next_mode[i] = next < MODES ? next : next - MODES;
    }
    for (Py_ssize_t i = 0; i < n; i++) {
        const double vx = state[SIZE * i + 2], vy = state[SIZE * i + 3];
        double speed = sqrt(vx * vx + vy * vy);
        speed = speed > smallest_speed ? speed : smallest_speed;
        half[i] = half_interval * (lateral[next_mode[i]] / speed);
    }
}

PyDoc_STRVAR(begin_doc,
"begin((state, mode, other, lateral, next_mode, half), particles, smallest_speed, half_interval)\n"
"--\n\nWrite next modes and halves of the turns; C-contiguous float64 and int64.");

static PyObject *begin(PyObject *module, PyObject *arguments)
{
    PyObject *tuple;
    Py_buffer b[LARGEST_NUMBER_OF_BUFFERS];
    Py_ssize_t n;
    double smallest_speed, half_interval;
    if (!PyArg_ParseTuple(arguments, "O!ndd", &PyTuple_Type, &tuple, &n, &smallest_speed,
                          &half_interval))
        return NULL;
    const Py_ssize_t sizes[6] = {SIZE * n, n, n, MODES, n, n};
    int held = take(tuple, b, sizes, 6, 2);
    if (!PyErr_Occurred()) {
        const Row *mode = b[1].buf, *other = b[2].buf;
        for (Py_ssize_t i = 0; i < n; i++)
            if (mode[i] < 0 || mode[i] >= MODES || other[i] < 0 || other[i] >= MODES) {
                PyErr_SetString(PyExc_ValueError, "There are three modes, from 0 to 2.");
                return released(b, held);
            }
        Py_BEGIN_ALLOW_THREADS
        begin_turns(n, b[0].buf, mode, other, b[3].buf, smallest_speed, half_interval, b[4].buf,
                    b[5].buf);
        Py_END_ALLOW_THREADS
    }
    return released(b, held);
}

/* By half of the turn, along the chord, and by the other half. */
static void finish_turns(Py_ssize_t n, const double *state, const double *half, const double *sine,
                         const double *cosine, const double *noise, double scale, double interval,
                         double *moved)
{
    const double half_interval = 0.5 * interval;
    for (Py_ssize_t i = 0; i < n; i++) {
        const double *s = state + SIZE * i, sin = sine[i], cos = cosine[i];
        const double chord = (half[i] != 0.0 ? sin / half[i] : 1.0) * interval;
        const double push_x = noise[2 * i] * scale, push_y = noise[2 * i + 1] * scale;
        const double mean_x = cos * s[2] - sin * s[3], mean_y = sin * s[2] + cos * s[3];
        double *m = moved + SIZE * i;
        m[0] = s[0] + (chord * mean_x + half_interval * push_x);
        m[1] = s[1] + (chord * mean_y + half_interval * push_y);
        m[2] = (cos * mean_x - sin * mean_y) + push_x;
        m[3] = (sin * mean_x + cos * mean_y) + push_y;
    }
}

PyDoc_STRVAR(finish_doc,
"finish((state, half, sine, cosine, noise, moved), particles, scale, interval)\n--\n\n"
"Write the states after the turns; C-contiguous float64.");

static PyObject *finish(PyObject *module, PyObject *arguments)
{
    PyObject *tuple;
    Py_buffer b[LARGEST_NUMBER_OF_BUFFERS];
    Py_ssize_t n;
    double scale, interval;
    if (!PyArg_ParseTuple(arguments, "O!ndd", &PyTuple_Type, &tuple, &n, &scale, &interval))
        return NULL;
    const Py_ssize_t sizes[6] = {SIZE * n, n, n, n, 2 * n, SIZE * n};
    int held = take(tuple, b, sizes, 6, 1);
    if (!PyErr_Occurred()) {
        Py_BEGIN_ALLOW_THREADS
        finish_turns(n, b[0].buf, b[1].buf, b[2].buf, b[3].buf, b[4].buf, scale, interval,
                     b[5].buf);
        Py_END_ALLOW_THREADS
    }
    return released(b, held);
}

static void moments_of(Py_ssize_t n, const double *share, const double *state, double *mean,
                       double *covariance)
{
    double sum[SIZE] = {0.0}, square[SIZE][SIZE] = {{0.0}};
    for (Py_ssize_t i = 0; i < n; i++)
        for (int a = 0; a < SIZE; a++)
            sum[a] += share[i] * state[SIZE * i + a];
    /* Those below the diagonal, too: whole rows take less time than parts of them. */
    for (Py_ssize_t i = 0; i < n; i++) {
        double away[SIZE], weighted[SIZE];
        for (int a = 0; a < SIZE; a++)
            away[a] = state[SIZE * i + a] - sum[a];
        for (int a = 0; a < SIZE; a++)
            weighted[a] = share[i] * away[a];
        for (int a = 0; a < SIZE; a++)
            for (int b = 0; b < SIZE; b++)
                square[a][b] += weighted[a] * away[b];
    }
    for (int a = 0; a < SIZE; a++) {
        mean[a] = sum[a];
        for (int b = a; b < SIZE; b++)
            covariance[SIZE * a + b] = covariance[SIZE * b + a] = square[a][b];
    }
}

PyDoc_STRVAR(moments_doc,
"moments((share, state, mean, covariance), clouds, particles)\n--\n\n"
"Write mean and covariance of each cloud; C-contiguous float64.");

static PyObject *moments(PyObject *module, PyObject *arguments)
{
    PyObject *tuple;
    Py_buffer b[LARGEST_NUMBER_OF_BUFFERS];
    Py_ssize_t clouds, n;
    if (!PyArg_ParseTuple(arguments, "O!nn", &PyTuple_Type, &tuple, &clouds, &n))
        return NULL;
    const Py_ssize_t sizes[4] = {clouds * n, SIZE * clouds * n, SIZE * clouds,
                                 SIZE * SIZE * clouds};
    int held = take(tuple, b, sizes, 4, 2);
    if (!PyErr_Occurred()) {
        Py_BEGIN_ALLOW_THREADS
        for (Py_ssize_t cloud = 0; cloud < clouds; cloud++)
            moments_of(n, (const double *)b[0].buf + n * cloud,
                       (const double *)b[1].buf + SIZE * n * cloud,
                       (double *)b[2].buf + SIZE * cloud,
                       (double *)b[3].buf + SIZE * SIZE * cloud);
        Py_END_ALLOW_THREADS
    }
    return released(b, held);
}

/* shrink s + (1 - shrink) mean + kernel noise, of the particles that are drawn */
static void spread_out(Py_ssize_t n, const double *state, const Row *drawn, const double *noise,
                       const double *centre, const double *kernel, double shrink, double *spread)
{
    for (Py_ssize_t i = 0; i < n; i++) {
        const double *s = state + SIZE * drawn[i], *w = noise + SIZE * i;
        for (int a = 0; a < SIZE; a++) {
            const double *k = kernel + SIZE * a;
            const double push = ((w[0] * k[0] + w[1] * k[1]) + w[2] * k[2]) + w[3] * k[3];
            spread[SIZE * i + a] = (s[a] * shrink + centre[a]) + push;
        }
    }
}

PyDoc_STRVAR(spread_doc,
"spread((state, drawn, noise, centre, kernel, spread), clouds, particles, shrink)\n--\n\n"
"Write the particles that are drawn, spread by a kernel; C-contiguous float64 and int64.");

static PyObject *spread(PyObject *module, PyObject *arguments)
{
    PyObject *tuple;
    Py_buffer b[LARGEST_NUMBER_OF_BUFFERS];
    Py_ssize_t clouds, n;
    double shrink;
    if (!PyArg_ParseTuple(arguments, "O!nnd", &PyTuple_Type, &tuple, &clouds, &n, &shrink))
        return NULL;
    const Py_ssize_t particles = clouds * n;
    const Py_ssize_t sizes[6] = {SIZE * particles, particles, SIZE * particles, SIZE * clouds,
                                 SIZE * SIZE * clouds, SIZE * particles};
    int held = take(tuple, b, sizes, 6, 1);
    if (!PyErr_Occurred()) {
        const Row *drawn = b[1].buf;
        for (Py_ssize_t i = 0; i < particles; i++)
            if (drawn[i] < 0 || drawn[i] >= n) {
                PyErr_SetString(PyExc_ValueError, "Particles are drawn that are not there.");
                return released(b, held);
            }
        Py_BEGIN_ALLOW_THREADS
        for (Py_ssize_t cloud = 0; cloud < clouds; cloud++)
            spread_out(n, (const double *)b[0].buf + SIZE * n * cloud, drawn + n * cloud,
                       (const double *)b[2].buf + SIZE * n * cloud,
                       (const double *)b[3].buf + SIZE * cloud,
                       (const double *)b[4].buf + SIZE * SIZE * cloud, shrink,
                       (double *)b[5].buf + SIZE * n * cloud);
        Py_END_ALLOW_THREADS
    }
    return released(b, held);
}

static PyMethodDef methods[] = {
    {"begin", begin, METH_VARARGS, begin_doc},
    {"finish", finish, METH_VARARGS, finish_doc},
    {"moments", moments, METH_VARARGS, moments_doc},
    {"spread", spread, METH_VARARGS, spread_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_clouds", "Clouds of particles, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_clouds(void)
{
    return PyModule_Create(&definition);
}
