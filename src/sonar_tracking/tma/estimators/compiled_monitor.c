/* What innovations say of lines and motion: innovation_monitor.py, compiled.
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

typedef struct {
    count lines, window, recent;
    double clip, outlier, outlier_count, line_threshold, motion_threshold, others_threshold;
} limits;

static double clipped(const limits *of, double value)
{
    return value < -of->clip ? -of->clip : value > of->clip ? of->clip : value;
}

static double sign(double value)
{
    return (value > 0.0) - (value < 0.0);
}

static double counted(const limits *of, double value)
{
    return fabs(value) > of->outlier ? of->outlier_count * sign(value) : clipped(of, value);
}

/* Standard normal deviate of the newest values of a window */
static double deviate(const limits *of, const double *window, count length,
                      double (*worth)(const limits *, double))
{
    const double *newest = window + of->window - length;
    double total = worth(of, newest[0]);
    for (count i = 1; i < length; i++)
        total += worth(of, newest[i]);
    return total / sqrt((double)length);
}

/* That of each line; returns the sum over the lines, which there are */
static double moving(const limits *of, const double *windows, const char *there, count length,
                     double *each)
{
    double total = 0.0;
    for (count line = 0; line < of->lines; line++) {
        each[line] = there[line] ? deviate(of, windows + line * of->window, length, counted) : 0.0;
        total = line ? total + each[line] : each[line];
    }
    return total;
}

/* One run: which lines to start anew; returns whether the target moves. Room for 3 n_lines */
static int judge(const limits *of, const double *windows, const double *azimuth, const char *there,
                 char *reborn, double *room)
{
    const count n = of->lines;
    double *line = room, *recent = room + n, *all = room + 2 * n;
    int moves = fabs(deviate(of, azimuth, of->window, counted)) > of->motion_threshold;
    count present = 0;
    for (count i = 0; i < n; i++) {
        present += there[i] != 0;
        line[i] = deviate(of, windows + i * of->window, of->recent, clipped);
    }
    const double others = sqrt((double)(present > 2 ? present - 1 : 1));
    const double recently = moving(of, windows, there, of->recent, recent);
    const double total = moving(of, windows, there, of->window, all);
    const double alike = of->motion_threshold * sqrt((double)(present > 1 ? present : 1));
    double strongest = 0.0;
    for (count i = 0; i < n; i++)
        strongest = fabs(all[i]) > strongest ? fabs(all[i]) : strongest;
    int common = 0;
    for (count i = 0; i < n; i++) {
        const int out = fabs(line[i]) > of->line_threshold && there[i];
        const int supported =
            (recently - recent[i]) / others * sign(line[i]) > of->others_threshold;
        moves |= out && supported;
        reborn[i] = (char)(out && !supported);
        common |= (total - all[i]) / others * sign(all[i]) > of->others_threshold &&
                  fabs(all[i]) == strongest;
    }
    moves |= common && fabs(total) > alike;
    if (moves)
        memset(reborn, 0, (size_t)n);
    return moves;
}

/* The newest innovation behind the others, if there is one */
static void push(const double *before, double *after, count window, double newest, int present)
{
    memcpy(after, before + (present ? 1 : 0), (size_t)(window - (present ? 1 : 0)) * sizeof(double));
    if (present)
        after[window - 1] = newest;
}

static void watch_one(const limits *of, const double *before, const double *azimuth,
                      const double *normalised, const char *present, double *after,
                      double *azimuth_after, char *reborn, char *manoeuvre, double *room)
{
    const size_t whole = (size_t)of->window * sizeof(double);
    push(azimuth, azimuth_after, of->window, normalised[0], present[0]);
    for (count line = 0; line < of->lines; line++)
        push(before + line * of->window, after + line * of->window, of->window,
             normalised[1 + line], present[1 + line]);
    *manoeuvre = (char)judge(of, after, azimuth_after, present + 1, reborn, room);
    for (count line = 0; line < of->lines; line++)
        if (*manoeuvre || reborn[line])
            memset(after + line * of->window, 0, whole);
    if (*manoeuvre)
        memset(azimuth_after, 0, whole);
}

PyDoc_STRVAR(watch_doc,
"watch(lines, azimuth, normalised, present, lines_after, azimuth_after, reborn, manoeuvre, limits,\n"
"      shape)\n--\n\n"
"Extend the windows of runs, judge and clear them: C-contiguous float64 and bool, limits = (clip,\n"
"outlier, what it counts, thresholds of a line, the motion and the others), shape = (runs, lines,\n"
"innovations in a window, those that judge a line).");

static PyObject *watch(PyObject *module, PyObject *arguments)
{
    Py_buffer lines, azimuth, normalised, present, lines_after, azimuth_after, reborn, manoeuvre;
    count runs;
    limits of;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*w*w*w*w*(dddddd)(nnnn)", &lines, &azimuth, &normalised,
                          &present, &lines_after, &azimuth_after, &reborn, &manoeuvre, &of.clip,
                          &of.outlier, &of.outlier_count, &of.line_threshold, &of.motion_threshold,
                          &of.others_threshold, &runs, &of.lines, &of.window, &of.recent))
        return NULL;
    const count real = (count)sizeof(double), n = of.lines;
    const int fits = runs >= 0 && n >= 0 && of.recent >= 1 && of.window >= of.recent &&
                     lines.len == runs * n * of.window * real && lines_after.len == lines.len &&
                     azimuth.len == runs * of.window * real && azimuth_after.len == azimuth.len &&
                     normalised.len == runs * (1 + n) * real && present.len == runs * (1 + n) &&
                     reborn.len == runs * n && manoeuvre.len == runs;
    if (!fits) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else {
        double *room = malloc((size_t)((3 * n + 1) * real));
        if (room == NULL) {
            PyErr_NoMemory();
        } else {
            Py_BEGIN_ALLOW_THREADS
            for (count i = 0; i < runs; i++)
                watch_one(&of, (const double *)lines.buf + i * n * of.window,
                          (const double *)azimuth.buf + i * of.window,
                          (const double *)normalised.buf + i * (1 + n),
                          (const char *)present.buf + i * (1 + n),
                          (double *)lines_after.buf + i * n * of.window,
                          (double *)azimuth_after.buf + i * of.window, (char *)reborn.buf + i * n,
                          (char *)manoeuvre.buf + i, room);
            Py_END_ALLOW_THREADS
            free(room);
        }
    }
    Py_buffer *all[] = {&lines,       &azimuth,       &normalised, &present,
                        &lines_after, &azimuth_after, &reborn,     &manoeuvre};
    for (int i = 0; i < 8; i++)
        PyBuffer_Release(all[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"watch", watch, METH_VARARGS, watch_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_monitor", "What innovations say, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_monitor(void)
{
    return PyModule_Create(&definition);
}
