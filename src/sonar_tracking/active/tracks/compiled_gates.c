/* Contacts in the gates of tracks: pair_search.py, compiled.
 *
 * In numpy the lists of all contacts in boxes around gates are written and read many times; here a
 * contact is left aside as soon as it is not one of the track. All operations are those of
 * pair_search.py in their order, and none is contracted: both give the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>

typedef long long Row; /* numpy's int64 */

/* One table after the other; the contacts of a scene are sorted by x. */
typedef struct {
    Py_ssize_t n_tracks, n_contacts, n_scenes, width; /* width of a covariance, 2 or 4 */
    const Row *track_ends, *contact_ends; /* of each scene */
    const Row *order;                     /* row of each sorted contact */
    const double *sorted_x, *sorted_y, *low_x, *high_x, *centre_y, *half_y;
    const double *mean, *spread, *threshold;
    const double *position, *covariance, *delay, *amplitude;
    double gate_square, smallest_share;
    Py_ssize_t crowd;
} Search;

typedef struct {
    Py_ssize_t count, capacity;
    Row *track, *contact;
    double *square;
    Row *place; /* of the contacts in a box */
    int crowded;
} Found;

/* First row of a stretch, sorted by x, that is not below a value. */
static Row not_below(const double *x, Row begin, Row end, double value)
{
    while (begin < end) {
        Row middle = begin + (end - begin) / 2;
        if (x[middle] < value)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

/* nu^T S^-1 nu */
static double squared_distance(const Search *s, Row track, Row contact)
{
    const double *mean = s->mean + 4 * track, *p = s->spread + s->width * s->width * track;
    const double *noise = s->covariance + 4 * contact, step = s->delay[contact];
    double x = s->position[2 * contact] - mean[0], y = s->position[2 * contact + 1] - mean[1];
    double xx = p[0], xy = p[1], yy = p[s->width + 1];
    if (s->width == 4) {
        x -= step * mean[2];
        y -= step * mean[3];
        xx = xx + step * (p[2] + p[2]) + step * step * p[10];
        xy = xy + step * (p[3] + p[6]) + step * step * p[11];
        yy = yy + step * (p[7] + p[7]) + step * step * p[15];
    }
    xx += noise[0];
    xy += noise[1];
    yy += noise[3];
    double product = xx * yy, area = product - xy * xy, least = s->smallest_share * product;
    if (area < least)
        area = least;
    double square = yy * (x * x) - 2.0 * xy * x * y;
    return (square + xx * (y * y)) / area;
}

static int add(Found *found, Row track, Row contact, double square)
{
    if (found->count == found->capacity) {
        Py_ssize_t capacity = found->capacity ? 2 * found->capacity : 4096;
        Row *tracks = realloc(found->track, (size_t)capacity * sizeof(Row));
        if (tracks != NULL)
            found->track = tracks;
        Row *contacts = realloc(found->contact, (size_t)capacity * sizeof(Row));
        if (contacts != NULL)
            found->contact = contacts;
        double *squares = realloc(found->square, (size_t)capacity * sizeof(double));
        if (squares != NULL)
            found->square = squares;
        if (tracks == NULL || contacts == NULL || squares == NULL)
            return -1;
        found->capacity = capacity;
    }
    found->track[found->count] = track;
    found->contact[found->count] = contact;
    found->square[found->count++] = square;
    return 0;
}

/* Drop those of the last pairs whose contact is below the threshold. */
static void drop_weak(const Search *s, Found *found, Py_ssize_t first)
{
    Py_ssize_t kept = first;
    for (Py_ssize_t i = first; i < found->count; i++) {
        if (s->amplitude[found->contact[i]] < s->threshold[found->track[i]])
            continue;
        found->track[kept] = found->track[i];
        found->contact[kept] = found->contact[i];
        found->square[kept++] = found->square[i];
    }
    found->count = kept;
}

/* In a crowd, contacts below the threshold count among the nearest, too. */
static int search_track(const Search *s, Found *found, Row track, Row begin, Row end)
{
    const double centre = s->centre_y[track], half = s->half_y[track];
    Row low = not_below(s->sorted_x, begin, end, s->low_x[track]);
    Row high = not_below(s->sorted_x, low, end, s->high_x[track]);
    Py_ssize_t boxed = 0, before = found->count;
    for (Row place = low; place < high; place++) { /* without a branch, which nobody foresees */
        found->place[boxed] = place;
        boxed += fabs(s->sorted_y[place] - centre) < half;
    }
    for (Py_ssize_t i = 0; i < boxed; i++) {
        Row contact = s->order[found->place[i]];
        if (boxed <= s->crowd && s->amplitude[contact] < s->threshold[track])
            continue;
        double square = squared_distance(s, track, contact);
        if (square < s->gate_square && add(found, track, contact, square) < 0)
            return -1;
    }
    if (found->count - before > s->crowd)
        found->crowded = 1;
    else if (boxed > s->crowd)
        drop_weak(s, found, before);
    return 0;
}

static int search_all(const Search *s, Found *found)
{
    Row track = 0, begin = 0;
    for (Py_ssize_t scene = 0; scene < s->n_scenes; scene++) {
        for (; track < s->track_ends[scene]; track++)
            if (search_track(s, found, track, begin, s->contact_ends[scene]) < 0)
                return -1;
        begin = s->contact_ends[scene];
    }
    return 0;
}

/* The order of the buffers that are given. */
enum { TRACK_ENDS, CONTACT_ENDS, ORDER, SORTED_X, SORTED_Y, LOW_X, HIGH_X, CENTRE_Y, HALF_Y, MEAN,
       SPREAD, THRESHOLD, POSITION, COVARIANCE, DELAY, AMPLITUDE, N_BUFFERS };

static int has_shape(const Search *s, const Py_buffer *buffer)
{
    const Py_ssize_t n = s->n_tracks, m = s->n_contacts, scenes = s->n_scenes;
    const Py_ssize_t sizes[N_BUFFERS] = {
        scenes, scenes, m, m, m, n, n, n, n, 4 * n, s->width * s->width * n, n, 2 * m, 4 * m, m, m,
    };
    for (int i = 0; i < N_BUFFERS; i++)
        if (buffer[i].len != sizes[i] * (Py_ssize_t)sizeof(double))
            return 0;
    Row tracks = 0, contacts = 0;
    for (Py_ssize_t i = 0; i < scenes; i++) {
        Row next_tracks = ((const Row *)buffer[TRACK_ENDS].buf)[i];
        Row next_contacts = ((const Row *)buffer[CONTACT_ENDS].buf)[i];
        if (next_tracks < tracks || next_contacts < contacts)
            return 0;
        tracks = next_tracks;
        contacts = next_contacts;
    }
    for (Py_ssize_t i = 0; i < m; i++) {
        Row row = ((const Row *)buffer[ORDER].buf)[i];
        if (row < 0 || row >= m)
            return 0;
    }
    return (s->width == 2 || s->width == 4) && tracks == n && contacts == m;
}

static void point_to(Search *s, const Py_buffer *b)
{
    s->track_ends = b[TRACK_ENDS].buf, s->contact_ends = b[CONTACT_ENDS].buf;
    s->order = b[ORDER].buf, s->sorted_x = b[SORTED_X].buf, s->sorted_y = b[SORTED_Y].buf;
    s->low_x = b[LOW_X].buf, s->high_x = b[HIGH_X].buf;
    s->centre_y = b[CENTRE_Y].buf, s->half_y = b[HALF_Y].buf;
    s->mean = b[MEAN].buf, s->spread = b[SPREAD].buf, s->threshold = b[THRESHOLD].buf;
    s->position = b[POSITION].buf, s->covariance = b[COVARIANCE].buf;
    s->delay = b[DELAY].buf, s->amplitude = b[AMPLITUDE].buf;
}

PyDoc_STRVAR(search_doc,
"search(buffers, shape, gate_square, smallest_share, crowd)\n--\n\n"
"Return rows of tracks and contacts (int64) and their squared distances (float64) as bytes, and\n"
"whether a gate is crowded. The buffers are C-contiguous, float64 and int64; shape = (tracks,\n"
"contacts, scenes, width of a covariance).");

static PyObject *search(PyObject *module, PyObject *arguments)
{
    PyObject *buffers, *result = NULL;
    Search s;
    Found found = {0};
    Py_buffer buffer[N_BUFFERS];
    int held = 0, failed = 0;
    if (!PyArg_ParseTuple(arguments, "O!(nnnn)ddn", &PyTuple_Type, &buffers, &s.n_tracks,
                          &s.n_contacts, &s.n_scenes, &s.width, &s.gate_square, &s.smallest_share,
                          &s.crowd))
        return NULL;
    if (PyTuple_GET_SIZE(buffers) != N_BUFFERS) {
        PyErr_SetString(PyExc_ValueError, "The number of buffers is wrong.");
        return NULL;
    }
    for (; held < N_BUFFERS; held++)
        if (PyObject_GetBuffer(PyTuple_GET_ITEM(buffers, held), &buffer[held], PyBUF_SIMPLE) < 0)
            break;
    if (held == N_BUFFERS && !has_shape(&s, buffer)) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else if (held == N_BUFFERS) {
        point_to(&s, buffer);
        found.place = malloc((size_t)(s.n_contacts + 1) * sizeof(Row));
        Py_BEGIN_ALLOW_THREADS
        failed = found.place == NULL || search_all(&s, &found) < 0;
        Py_END_ALLOW_THREADS
        const Py_ssize_t rows = found.count * (Py_ssize_t)sizeof(Row);
        if (failed)
            PyErr_NoMemory();
        else
            result = Py_BuildValue("y#y#y#O", found.track ? (char *)found.track : "", rows,
                                   found.contact ? (char *)found.contact : "", rows,
                                   found.square ? (char *)found.square : "", rows,
                                   found.crowded ? Py_True : Py_False);
    }
    while (held-- > 0)
        PyBuffer_Release(&buffer[held]);
    free(found.place);
    free(found.track);
    free(found.contact);
    free(found.square);
    return result;
}

static PyMethodDef methods[] = {
    {"search", search, METH_VARARGS, search_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_gates", "Contacts in gates, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_gates(void)
{
    return PyModule_Create(&definition);
}
