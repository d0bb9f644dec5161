/* Modes of a bank that change into each other and move: motion_modes.py and weaving.py, compiled.
 *
 * All operations are those written there in their order, and none is contracted: both give the same
 * bits. The modes of a hypothesis are neighbours: straight, manoeuvring, wandering, weaving with a
 * short, a middle and a long period. The last four states of each are the deviation of a target
 * that weaves and its rate.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <stdlib.h>
#include <string.h>

typedef Py_ssize_t count;

enum { MIXED = 2, WEAVING = 3, WEAVES = 3, MODES = WEAVING + WEAVES };
enum { DEVIATION = 4, KINEMATIC = 4 };

/* The first two modes of one hypothesis take over from each other; room for (2 n + 1) n numbers */
static void mix_one(double *mean, double *covariance, const double *other, count n, double *room)
{
    const count states = n - DEVIATION, square = n * n;
    double *apart = room, *swapped = room + n;
    for (count i = 0; i < states; i++)
        apart[i] = mean[n + i] - mean[i];
    for (count mode = 0; mode < MIXED; mode++) {
        const double *own = covariance + mode * square, *rest = covariance + (1 - mode) * square;
        for (count i = 0; i < states; i++)
            for (count j = 0; j < states; j++)
                swapped[mode * square + i * n + j] = rest[i * n + j] - own[i * n + j];
    }
    for (count mode = 0; mode < MIXED; mode++) {
        const double share = other[mode], kept = 1.0 - share;
        double *own = covariance + mode * square;
        for (count i = 0; i < states; i++)
            for (count j = 0; j < states; j++) {
                double change = swapped[mode * square + i * n + j];
                change += kept * (apart[i] * apart[j]);
                own[i * n + j] += share * change;
            }
    }
    for (count i = 0; i < states; i++) {
        const double first = mean[i], second = mean[n + i];
        mean[i] += other[0] * (second - first);
        mean[n + i] += other[1] * (first - second);
    }
}

/* Constant velocity and white acceleration of the first states, row length n */
static void move_straight(double *mean, double *covariance, count states, count n, double elapsed,
                          double density)
{
    for (count i = 0; i < 2; i++)
        mean[i] += elapsed * mean[2 + i];
    for (count i = 0; i < 2; i++)
        for (count j = 0; j < states; j++)
            covariance[i * n + j] += elapsed * covariance[(2 + i) * n + j];
    for (count i = 0; i < states; i++)
        for (count j = 0; j < 2; j++)
            covariance[i * n + j] += elapsed * covariance[i * n + 2 + j];
    const double squared = elapsed * elapsed, between = density * squared / 2.0;
    for (count axis = 0; axis < 2; axis++) {
        covariance[axis * n + axis] += density * (squared * elapsed) / 3.0;
        covariance[axis * n + 2 + axis] += between;
        covariance[(2 + axis) * n + axis] += between;
        covariance[(2 + axis) * n + 2 + axis] += density * elapsed;
    }
}

/* The deviation changes, and with it the target; one column of states a stride apart */
static void change(double *states, count n, count stride, const double *step, double elapsed)
{
    const double kept = step[0], carried = step[1], pulled = step[2], slowed = step[3];
    for (count axis = 0; axis < 2; axis++) {
        double *deviation = states + (n - DEVIATION + axis) * stride;
        double *speed = states + (n - 2 + axis) * stride;
        states[axis * stride] += (kept - 1.0) * *deviation + (carried - elapsed) * *speed;
        states[(2 + axis) * stride] += pulled * *deviation + (slowed - 1.0) * *speed;
        const double moved = kept * *deviation + carried * *speed;
        *speed = pulled * *deviation + slowed * *speed;
        *deviation = moved;
    }
}

static void move_weaving(double *mean, double *covariance, count n, double elapsed, double density,
                         const double *step, const double *noise)
{
    move_straight(mean, covariance, n, n, elapsed, density);
    change(mean, n, 1, step, elapsed);
    for (count j = 0; j < n; j++)
        change(covariance + j, n, n, step, elapsed);
    for (count i = 0; i < n; i++)
        change(covariance + i * n, n, 1, step, elapsed);
    for (count axis = 0; axis < 2; axis++) {
        const count places[4] = {axis, 2 + axis, n - DEVIATION + axis, n - 2 + axis};
        const count kinds[4] = {0, 1, 0, 1};
        for (count a = 0; a < 4; a++)
            for (count b = 0; b < 4; b++)
                covariance[places[a] * n + places[b]] += noise[2 * kinds[a] + kinds[b]];
    }
}

PyDoc_STRVAR(mix_doc,
"mix(mean, covariance, other, shape)\n--\n\n"
"Let the first two modes take over from each other, in place: C-contiguous float64, shape =\n"
"(hypotheses, states).");

static PyObject *mix(PyObject *module, PyObject *arguments)
{
    Py_buffer mean, covariance, other;
    count hypotheses, n;
    if (!PyArg_ParseTuple(arguments, "w*w*y*(nn)", &mean, &covariance, &other, &hypotheses, &n))
        return NULL;
    const count real = (count)sizeof(double);
    if (hypotheses < 0 || n < KINEMATIC + DEVIATION || mean.len != hypotheses * MODES * n * real ||
        covariance.len != hypotheses * MODES * n * n * real ||
        other.len != hypotheses * MIXED * real) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else {
        double *room = malloc((size_t)((2 * n + 1) * n * real));
        if (room == NULL) {
            PyErr_NoMemory();
        } else {
            Py_BEGIN_ALLOW_THREADS
            for (count i = 0; i < hypotheses; i++)
                mix_one((double *)mean.buf + i * MODES * n,
                        (double *)covariance.buf + i * MODES * n * n,
                        (const double *)other.buf + i * MIXED, n, room);
            Py_END_ALLOW_THREADS
            free(room);
        }
    }
    PyBuffer_Release(&mean);
    PyBuffer_Release(&covariance);
    PyBuffer_Release(&other);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

PyDoc_STRVAR(move_doc,
"move(mean, covariance, elapsed, transition, noise, densities, shape)\n--\n\n"
"Move all modes, in place: C-contiguous float64, transitions and noise of the deviations of each\n"
"hypothesis, densities of the acceleration (straight, manoeuvring, wandering), shape = (hypotheses, states).");

static PyObject *move(PyObject *module, PyObject *arguments)
{
    Py_buffer mean, covariance, elapsed, transition, noise;
    double densities[WEAVING];
    count hypotheses, n;
    if (!PyArg_ParseTuple(arguments, "w*w*y*y*y*(ddd)(nn)", &mean, &covariance, &elapsed,
                          &transition, &noise, &densities[0], &densities[1], &densities[2],
                          &hypotheses, &n))
        return NULL;
    const count real = (count)sizeof(double);
    if (hypotheses < 0 || n < KINEMATIC + DEVIATION || mean.len != hypotheses * MODES * n * real ||
        covariance.len != hypotheses * MODES * n * n * real || elapsed.len != hypotheses * real ||
        transition.len != hypotheses * 4 * WEAVES * real ||
        noise.len != hypotheses * 4 * WEAVES * real) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else {
        Py_BEGIN_ALLOW_THREADS
        for (count i = 0; i < hypotheses; i++) {
            double *state = (double *)mean.buf + i * MODES * n;
            double *spread = (double *)covariance.buf + i * MODES * n * n;
            const double step = ((const double *)elapsed.buf)[i];
            for (count mode = 0; mode < WEAVING; mode++)
                move_straight(state + mode * n, spread + mode * n * n, n - DEVIATION, n, step,
                              densities[mode]);
            for (count weave = 0; weave < WEAVES; weave++) {
                const count mode = WEAVING + weave, place = 4 * (WEAVES * i + weave);
                move_weaving(state + mode * n, spread + mode * n * n, n, step, densities[0],
                             (const double *)transition.buf + place,
                             (const double *)noise.buf + place);
            }
        }
        Py_END_ALLOW_THREADS
    }
    PyBuffer_Release(&mean);
    PyBuffer_Release(&covariance);
    PyBuffer_Release(&elapsed);
    PyBuffer_Release(&transition);
    PyBuffer_Release(&noise);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"mix", mix, METH_VARARGS, mix_doc},
    {"move", move, METH_VARARGS, move_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_modes", "Modes of a bank, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_modes(void)
{
    return PyModule_Create(&definition);
}
