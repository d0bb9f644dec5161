/* What a moving sensor measures of a moving source: measurement_model.py, compiled.
 *
 * All operations are those written there in their order, and none is contracted: both give the same
 * bits. Arc tangents are left to numpy, between the two functions.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <string.h>

typedef Py_ssize_t count;

enum { KINEMATIC = 4, AZIMUTH = 0, ELEVATION = 1, FIRST_LINE = 2, RELATED = 7 };
/* Of a state seen from the sensor; the first two pairs are what arc tangents are taken of */
enum { NORTH, HEIGHT, EAST, DISTANCE, ALONG_EAST, ALONG_NORTH, DELAY };

typedef struct {
    count entries, components, states, lines, vertical;
} sizes;

typedef struct {
    double sound_speed, propagation_speed, height, sensor_z, minimum_range;
} constants;

/* Whether a buffer has so many numbers for each entry, or the same ones for all */
static int has(const Py_buffer *column, count width, count entries)
{
    return column->len == width || column->len == width * entries;
}

/* Those of one entry */
static const double *of_entry(const Py_buffer *column, count width, count entry)
{
    const int own = column->len != width * (count)sizeof(double);
    return (const double *)column->buf + (own ? entry * width : 0);
}

static void relate_one(const sizes *of, const constants *with, const double *mean,
                       const double *position, const double *velocity, double *out, count stride)
{
    const double now[2] = {mean[0] - position[0], mean[1] - position[1]};
    double delay = hypot(now[0], now[1]) / with->propagation_speed;
    const double then[2] = {now[0] - delay * mean[2], now[1] - delay * mean[3]};
    delay = hypot(then[0], then[1]) / with->propagation_speed;
    const double offset[2] = {now[0] - delay * mean[2], now[1] - delay * mean[3]};
    const double range = hypot(offset[0], offset[1]);
    const double distance = range < with->minimum_range ? with->minimum_range : range;
    const count place = KINEMATIC + of->lines;
    out[NORTH * stride] = offset[1] / distance;
    out[EAST * stride] = offset[0] / distance;
    out[ALONG_EAST * stride] = mean[2] - velocity[0];
    out[ALONG_NORTH * stride] = mean[3] - velocity[1];
    out[DISTANCE * stride] = distance;
    out[DELAY * stride] = delay;
    out[HEIGHT * stride] =
        of->vertical ? mean[place] - delay * mean[place + 1] - with->sensor_z : with->height;
}

static double wrapped(double angle)
{
    double rest = fmod(angle + Py_MATH_PI, 2.0 * Py_MATH_PI);
    if (rest == 0.0)
        rest = 0.0;
    else if (rest < 0.0)
        rest += 2.0 * Py_MATH_PI;
    return rest - Py_MATH_PI;
}

/* The innovation of the azimuth, of several the one nearest to what is expected */
static double nearest(const double *azimuth, count sides, double expected)
{
    double best = wrapped(azimuth[0] - expected);
    for (count side = 1; side < sides && !isnan(best); side++) {
        const double one = wrapped(azimuth[side] - expected);
        if (isnan(one) || fabs(one) < fabs(best))
            best = one;
    }
    return best;
}

typedef struct {
    const double *mean, *related, *azimuth, *azimuth_variance, *elevation, *elevation_variance;
    const double *frequency, *deviation;
    const char *known;
    double expected_azimuth, expected_elevation;
    count sides, stride;
} seen;

static void line_rows(const sizes *of, const constants *with, const seen *one, double *innovation,
                      double *derivative, double *variance, char *present, count size)
{
    const double *at = one->related;
    const count step = one->stride;
    const double x = at[EAST * step], y = at[NORTH * step], distance = at[DISTANCE * step];
    const double east = at[ALONG_EAST * step], north = at[ALONG_NORTH * step];
    const double rate = x * east + y * north;
    double speed = with->sound_speed;
    double gradient[KINEMATIC] = {(east - rate * x) / distance, (north - rate * y) / distance, x, y};
    if (isfinite(with->propagation_speed)) {
        const double vx = one->mean[2], vy = one->mean[3], own = x * vx + y * vy;
        speed = speed + own;
        const double share = rate / speed;
        gradient[0] -= share * ((vx - own * x) / distance);
        gradient[1] -= share * ((vy - own * y) / distance);
        gradient[2] -= share * x;
        gradient[3] -= share * y;
    }
    const double factor = 1.0 - rate / speed;
    for (count i = 0; i < KINEMATIC; i++)
        gradient[i] = gradient[i] / -speed;
    for (count line = 0; line < of->lines; line++) {
        const count row = FIRST_LINE + line;
        const double source = one->mean[KINEMATIC + line];
        innovation[row] = one->frequency[line] - source * factor;
        for (count i = 0; i < KINEMATIC; i++)
            derivative[row * size + i] = source * gradient[i];
        derivative[row * size + KINEMATIC + line] = factor;
        variance[row] = one->deviation[line] * one->deviation[line];
        present[row] = one->known[line];
    }
}

static void linearise_one(const sizes *of, const constants *with, const seen *one,
                          double *innovation, double *derivative, double *variance, char *present)
{
    const count rows = FIRST_LINE + of->lines, place = KINEMATIC + of->lines;
    const count size = place + (of->vertical ? 2 : 0), step = one->stride;
    const double *at = one->related;
    const double x = at[EAST * step], y = at[NORTH * step], distance = at[DISTANCE * step];
    const double height = at[HEIGHT * step], delay = at[DELAY * step];
    const double slant = distance * distance + height * height, slope = -height / slant;
    memset(derivative, 0, (size_t)(rows * size) * sizeof(double));
    innovation[AZIMUTH] = nearest(one->azimuth, one->sides, one->expected_azimuth);
    derivative[0] = -y / distance;
    derivative[1] = x / distance;
    variance[AZIMUTH] = *one->azimuth_variance;
    innovation[ELEVATION] = *one->elevation - one->expected_elevation;
    derivative[size] = slope * x;
    derivative[size + 1] = slope * y;
    if (of->vertical) {
        const double rise = distance / slant;
        derivative[size + place] = rise;
        derivative[size + place + 1] = -delay * rise;
    }
    variance[ELEVATION] = *one->elevation_variance;
    present[AZIMUTH] = present[ELEVATION] = 1;
    line_rows(of, with, one, innovation, derivative, variance, present, size);
    const double vx = one->mean[2], vy = one->mean[3];
    const double speed = with->propagation_speed + (x * vx + y * vy);
    for (count row = 0; row < rows; row++) {
        double *own = derivative + row * size;
        if (isfinite(with->propagation_speed)) {
            const double moved = (own[0] * vx + own[1] * vy) / speed;
            own[0] -= moved * x;
            own[1] -= moved * y;
        }
        for (count i = 0; i < 2; i++)
            own[2 + i] -= own[i] * delay;
        if (present[row] && isfinite(innovation[row]) && isfinite(variance[row]))
            continue;
        present[row] = 0;
        innovation[row] = 0.0;
        variance[row] = 1.0;
        memset(own, 0, (size_t)size * sizeof(double));
    }
}

PyDoc_STRVAR(relate_doc,
"relate(mean, position, velocity, related, constants, shape)\n--\n\n"
"See states from their sensor: C-contiguous float64; constants = (sound speed, propagation speed,\n"
"height, z of the sensor, least range), shape = (entries, components, states, lines, vertical).\n"
"Of each component: north and height, east and distance, velocity east and north, travel time.");

static PyObject *relate(PyObject *module, PyObject *arguments)
{
    Py_buffer mean, position, velocity, related;
    sizes of;
    constants with;
    if (!PyArg_ParseTuple(arguments, "y*y*y*w*(ddddd)(nnnnn)", &mean, &position, &velocity, &related,
                          &with.sound_speed, &with.propagation_speed, &with.height, &with.sensor_z,
                          &with.minimum_range, &of.entries, &of.components, &of.states, &of.lines,
                          &of.vertical))
        return NULL;
    const count real = (count)sizeof(double), all = of.entries * of.components;
    const int fits = of.entries >= 0 && of.components >= 1 && of.lines >= 0 &&
                     of.states >= KINEMATIC + of.lines + (of.vertical ? 2 : 0) &&
                     mean.len == all * of.states * real && related.len == RELATED * all * real &&
                     has(&position, 2 * real, of.entries) && has(&velocity, 2 * real, of.entries);
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    for (count i = 0; fits && i < all; i++)
        relate_one(&of, &with, (const double *)mean.buf + i * of.states,
                   of_entry(&position, 2, i / of.components),
                   of_entry(&velocity, 2, i / of.components), (double *)related.buf + i, all);
    Py_buffer *every[] = {&mean, &position, &velocity, &related};
    for (int i = 0; i < 4; i++)
        PyBuffer_Release(every[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

/* Columns of a measurement, in the order in which they are given, and what comes of them */
enum { AZIMUTHS, AZIMUTH_VARIANCE, ELEVATIONS, ELEVATION_VARIANCE, FREQUENCY, LINE_DEVIATION, MEASURED };
enum { INNOVATION, DERIVATIVE, VARIANCE, PRESENT, FOUND };

PyDoc_STRVAR(linearise_doc,
"linearise(mean, related, angles, known, azimuth, azimuth_variance, elevation, elevation_variance,\n"
"          frequency, deviation, innovation, derivative, variance, present, constants, shape,\n"
"          sides)\n--\n\n"
"Linearise the rows at states that were related: C-contiguous float64, known and present bool; the\n"
"expected angles are the azimuths, then the elevations; columns of each entry, or one for all.");

static PyObject *linearise(PyObject *module, PyObject *arguments)
{
    Py_buffer mean, related, angles, known, in[MEASURED], out[FOUND];
    sizes of;
    constants with;
    count sides;
    if (!PyArg_ParseTuple(
            arguments, "y*y*y*y*y*y*y*y*y*y*w*w*w*w*(ddddd)(nnnnn)n", &mean, &related, &angles,
            &known, &in[0], &in[1], &in[2], &in[3], &in[4], &in[5], &out[0], &out[1], &out[2],
            &out[3], &with.sound_speed, &with.propagation_speed, &with.height, &with.sensor_z,
            &with.minimum_range, &of.entries, &of.components, &of.states, &of.lines, &of.vertical,
            &sides))
        return NULL;
    const count real = (count)sizeof(double), all = of.entries * of.components, n = of.lines;
    const count rows = FIRST_LINE + n, size = KINEMATIC + n + (of.vertical ? 2 : 0);
    int fits = of.entries >= 0 && of.components >= 1 && n >= 0 && sides >= 1 && of.states >= size &&
               mean.len == all * of.states * real && related.len == RELATED * all * real &&
               angles.len == 2 * all * real && has(&known, n, of.entries) &&
               out[INNOVATION].len == all * rows * real && out[PRESENT].len == all * rows &&
               out[DERIVATIVE].len == all * rows * size * real &&
               out[VARIANCE].len == all * rows * real;
    const count widths[MEASURED] = {sides, 1, 1, 1, n, n};
    for (int i = 0; i < MEASURED; i++)
        fits = fits && has(&in[i], widths[i] * real, of.entries);
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    for (count i = 0; fits && i < all; i++) {
        const count entry = i / of.components;
        const seen one = {
            (const double *)mean.buf + i * of.states,
            (const double *)related.buf + i,
            of_entry(&in[AZIMUTHS], sides, entry),
            of_entry(&in[AZIMUTH_VARIANCE], 1, entry),
            of_entry(&in[ELEVATIONS], 1, entry),
            of_entry(&in[ELEVATION_VARIANCE], 1, entry),
            of_entry(&in[FREQUENCY], n, entry),
            of_entry(&in[LINE_DEVIATION], n, entry),
            (const char *)known.buf + (known.len == n ? 0 : entry * n),
            ((const double *)angles.buf)[i],
            ((const double *)angles.buf)[all + i],
            sides,
            all,
        };
        linearise_one(&of, &with, &one, (double *)out[INNOVATION].buf + i * rows,
                      (double *)out[DERIVATIVE].buf + i * rows * size,
                      (double *)out[VARIANCE].buf + i * rows, (char *)out[PRESENT].buf + i * rows);
    }
    Py_buffer *every[] = {&mean, &related, &angles, &known};
    for (int i = 0; i < 4; i++)
        PyBuffer_Release(every[i]);
    for (int i = 0; i < MEASURED; i++)
        PyBuffer_Release(&in[i]);
    for (int i = 0; i < FOUND; i++)
        PyBuffer_Release(&out[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"relate", relate, METH_VARARGS, relate_doc},
    {"linearise", linearise, METH_VARARGS, linearise_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_rows", "Rows of a measurement, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_rows(void)
{
    return PyModule_Create(&definition);
}
