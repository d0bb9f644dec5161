/* Information of all measurements on a motion: observability.py, compiled.
 *
 * All operations are those of observability.py in their order, and none is contracted: both give
 * the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef Py_ssize_t count;

enum { TIME, X, Y, VX, VY, AZIMUTH, ELEVATION, HEIGHT, LINES }; /* columns of a history */
enum { MOTION = 4, UPPER = 10 };

/* One measurement against the track: its line of sight, and derivatives of what lines tell */
typedef struct {
    double east, north, distance, factor, doppler[MOTION];
} sight;

static void add_weighted(const double *row, double weight, double *sum)
{
    count place = 0;
    for (count i = 0; i < MOTION; i++)
        for (count j = i; j < MOTION; j++)
            sum[place++] += (row[i] * weight) * row[j];
}

static void add_upper(const double *sum, double scale, double *information)
{
    count place = 0;
    for (count i = 0; i < MOTION; i++)
        for (count j = i; j < MOTION; j++, place++) {
            information[MOTION * i + j] += scale * sum[place];
            if (i != j)
                information[MOTION * j + i] += scale * sum[place];
        }
}

/* Derivatives by the position as those by the motion at the first time */
static void on_first(double by_x, double by_y, double since, double *row)
{
    row[0] = by_x;
    row[1] = by_y;
    row[2] = by_x * since;
    row[3] = by_y * since;
}

static void see(const double *row, double last, const double *mean, sight *seen)
{
    const double before = row[TIME] - last;
    const double x = mean[0] + mean[2] * before - row[X], y = mean[1] + mean[3] * before - row[Y];
    seen->distance = fmax(hypot(x, y), 1.0);
    seen->east = x / seen->distance;
    seen->north = y / seen->distance;
}

static void add_directions(const double *row, const sight *seen, double *azimuth, double *elevation)
{
    double own[MOTION];
    const double distance = seen->distance, height = row[HEIGHT];
    on_first(-seen->north / distance, seen->east / distance, row[TIME], own);
    add_weighted(own, row[AZIMUTH], azimuth);
    if (row[ELEVATION] == 0.0)
        return;
    const double slope = -height / (distance * distance + height * height);
    on_first(slope * seen->east, slope * seen->north, row[TIME], own);
    add_weighted(own, row[ELEVATION], elevation);
}

static void hear(const double *row, const double *mean, double sound_speed, sight *seen)
{
    const double vx = mean[2] - row[VX], vy = mean[3] - row[VY];
    const double rate = seen->east * vx + seen->north * vy;
    on_first((vx - rate * seen->east) / seen->distance, (vy - rate * seen->north) / seen->distance,
             row[TIME], seen->doppler);
    seen->doppler[2] += seen->east;
    seen->doppler[3] += seen->north;
    seen->factor = 1.0 - rate / sound_speed;
}

/* What a line tells once its source frequency has to be found from it, too */
static void add_line(const double *weight, count frames, count width, const sight *seen,
                     double scale, double *information)
{
    double own = 0.0, common[MOTION] = {0.0}, sum[UPPER] = {0.0}, left[MOTION];
    for (count t = 0; t < frames; t++) {
        const double w = weight[t * width], factor = seen[t].factor;
        own += w * (factor * factor);
        for (count k = 0; k < MOTION; k++)
            common[k] += w * factor * seen[t].doppler[k];
    }
    if (!(own > 0.0))
        return;
    for (count k = 0; k < MOTION; k++)
        common[k] /= own;
    for (count t = 0; t < frames; t++) {
        for (count k = 0; k < MOTION; k++)
            left[k] = seen[t].doppler[k] - seen[t].factor * common[k];
        add_weighted(left, weight[t * width], sum);
    }
    add_upper(sum, scale, information);
}

PyDoc_STRVAR(inform_doc,
"inform(history, mean, scale, information, shape, sound_speed)\n--\n\n"
"Add up the information of a history: C-contiguous float64, shape = (frames, columns, lines); scale\n"
"is that of each line, and the information, which is overwritten, of 4 by 4.");

static PyObject *inform(PyObject *module, PyObject *arguments)
{
    Py_buffer history, mean, scale, information;
    count frames, width, lines;
    double sound_speed;
    if (!PyArg_ParseTuple(arguments, "y*y*y*w*(nnn)d", &history, &mean, &scale, &information,
                          &frames, &width, &lines, &sound_speed))
        return NULL;
    const count real = (count)sizeof(double);
    sight *seen = NULL;
    if (frames < 1 || lines < 0 || width < LINES + lines || history.len != frames * width * real ||
        mean.len != MOTION * real || scale.len != lines * real ||
        information.len != MOTION * MOTION * real) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else if ((seen = malloc((size_t)frames * sizeof(sight))) == NULL) {
        PyErr_NoMemory();
    } else {
        const double *table = history.buf, *last = table + (frames - 1) * width;
        double azimuth[UPPER] = {0.0}, elevation[UPPER] = {0.0}, *total = information.buf;
        memset(total, 0, MOTION * MOTION * sizeof(double));
        for (count t = 0; t < frames; t++) {
            see(table + t * width, last[TIME], mean.buf, seen + t);
            add_directions(table + t * width, seen + t, azimuth, elevation);
            if (lines)
                hear(table + t * width, mean.buf, sound_speed, seen + t);
        }
        add_upper(azimuth, 1.0, total);
        add_upper(elevation, 1.0, total);
        for (count line = 0; line < lines; line++)
            add_line(table + LINES + line, frames, width, seen, ((const double *)scale.buf)[line],
                     total);
    }
    free(seen);
    Py_buffer *all[] = {&history, &mean, &scale, &information};
    for (int i = 0; i < 4; i++)
        PyBuffer_Release(all[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"inform", inform, METH_VARARGS, inform_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_information", "Information on a motion, compiled.", -1,
    methods, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_information(void)
{
    return PyModule_Create(&definition);
}
