/* Pairs of particles and contacts near each other: particle_densities.py, compiled.
 *
 * All operations are those of particle_densities.py in their order, and none is contracted: both
 * give the same bits. Ranges, azimuths and exponentials are those of numpy.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>

#define PI 3.141592653589793
#define LEAST_SECTORS 3 /* with fewer all contacts are compared */

typedef long long Row; /* numpy's int64 */

typedef struct {
    Py_ssize_t n, m, sectors, room;
    const double *range, *azimuth, *contact_range, *contact_azimuth;
    double range_deviation, azimuth_deviation, farthest;
    Row *particle, *contact;
    double *square;
    Py_ssize_t *begins, *rows; /* of the contacts of each sector, shape (sectors + 1,) and (m,) */
} Near;

static Py_ssize_t sector_of(const Near *a, double azimuth)
{
    const double share = (azimuth + PI) * ((double)a->sectors / (2.0 * PI));
    if (!(share > 0.0))
        return 0;
    return share < (double)(a->sectors - 1) ? (Py_ssize_t)share : a->sectors - 1;
}

static void sort_contacts(const Near *a)
{
    for (Py_ssize_t s = 0; s <= a->sectors; s++)
        a->begins[s] = 0;
    for (Py_ssize_t j = 0; j < a->m; j++)
        a->begins[sector_of(a, a->contact_azimuth[j]) + 1]++;
    for (Py_ssize_t s = 0; s < a->sectors; s++)
        a->begins[s + 1] += a->begins[s];
    /* From behind, so that what a sector has is left in order and begins end where they began. */
    for (Py_ssize_t j = a->m; j-- > 0;)
        a->rows[--a->begins[sector_of(a, a->contact_azimuth[j]) + 1]] = j;
    for (Py_ssize_t s = 0; s < a->sectors; s++)
        a->begins[s] = a->begins[s + 1];
    a->begins[a->sectors] = a->m;
}

/* Write the pairs of a particle with some contacts behind those found; those beyond the room are
 * counted only. Returns how many there are. */
static Py_ssize_t compare(const Near *a, Py_ssize_t i, Py_ssize_t begin, Py_ssize_t end,
                          Py_ssize_t found)
{
    for (Py_ssize_t k = begin; k < end; k++) {
        const Py_ssize_t j = a->rows[k];
        const double along = (a->contact_range[j] - a->range[i]) / a->range_deviation;
        if (!(fabs(along) < a->farthest))
            continue;
        const double turn = a->contact_azimuth[j] - a->azimuth[i];
        const double across =
            (turn - 2.0 * PI * rint(turn / (2.0 * PI))) / a->azimuth_deviation;
        if (!(fabs(across) < a->farthest))
            continue;
        if (found < a->room) {
            a->particle[found] = (Row)i;
            a->contact[found] = (Row)j;
            a->square[found] = along * along + across * across;
        }
        found++;
    }
    return found;
}

static Py_ssize_t find_pairs(const Near *a)
{
    Py_ssize_t found = 0;
    sort_contacts(a);
    for (Py_ssize_t i = 0; i < a->n; i++) {
        if (a->sectors < LEAST_SECTORS) {
            found = compare(a, i, 0, a->m, found);
            continue;
        }
        const Py_ssize_t own = sector_of(a, a->azimuth[i]);
        for (Py_ssize_t s = own - 1; s <= own + 1; s++) {
            const Py_ssize_t sector = (s + a->sectors) % a->sectors;
            found = compare(a, i, a->begins[sector], a->begins[sector + 1], found);
        }
    }
    return found;
}

PyDoc_STRVAR(near_doc,
"near((range, azimuth, contact_range, contact_azimuth, particle, contact, square), sectors,\n"
"     range_deviation, azimuth_deviation, farthest)\n--\n\n"
"Write the rows of near particles and contacts and their squared distances, as many as there is\n"
"room for, and return how many there are; C-contiguous float64 and int64.");

static int fits(const Py_buffer *b)
{
    for (int i = 0; i < 7; i++)
        if (b[i].len % 8)
            return 0;
    return b[0].len == b[1].len && b[2].len == b[3].len && b[4].len == b[5].len &&
           b[4].len == b[6].len;
}

static PyObject *near(PyObject *module, PyObject *arguments)
{
    Py_buffer b[7];
    Near a = {0};
    Py_ssize_t found = 0;
    if (!PyArg_ParseTuple(arguments, "(y*y*y*y*w*w*w*)nddd", &b[0], &b[1], &b[2], &b[3], &b[4],
                          &b[5], &b[6], &a.sectors, &a.range_deviation, &a.azimuth_deviation,
                          &a.farthest))
        return NULL;
    a.n = b[0].len / 8, a.m = b[2].len / 8, a.room = b[4].len / 8;
    if (a.sectors < LEAST_SECTORS)
        a.sectors = 1;
    a.range = b[0].buf, a.azimuth = b[1].buf;
    a.contact_range = b[2].buf, a.contact_azimuth = b[3].buf;
    a.particle = b[4].buf, a.contact = b[5].buf, a.square = b[6].buf;
    a.begins = malloc(((size_t)a.sectors + 1 + (size_t)a.m) * sizeof(Py_ssize_t));
    if (!fits(b)) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else if (a.begins == NULL) {
        PyErr_NoMemory();
    } else {
        a.rows = a.begins + a.sectors + 1;
        Py_BEGIN_ALLOW_THREADS
        found = find_pairs(&a);
        Py_END_ALLOW_THREADS
    }
    free(a.begins);
    for (int i = 0; i < 7; i++)
        PyBuffer_Release(&b[i]);
    return PyErr_Occurred() ? NULL : PyLong_FromSsize_t(found);
}

static PyMethodDef methods[] = {
    {"near", near, METH_VARARGS, near_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_densities", "Near particles and contacts, compiled.", -1,
    methods, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_densities(void)
{
    return PyModule_Create(&definition);
}
