/* Weighted k-means on position: weighted_clusters.py, compiled.
 *
 * All operations are those of weighted_clusters.py in their order, and none is contracted: both
 * give the same bits.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <stdlib.h>

#define LEAST_MASS 1e-300

typedef long long Row; /* numpy's int64 */

typedef struct {
    Py_ssize_t n, k;
    const double *x, *y, *weight, *luck;
    Row *label, *order, *counts;
    double *edges, *square; /* of the seeding, shape (n,) */
    double *centre_x, *centre_y, *mass, *sum_x, *sum_y; /* shape (k,) */
    double middle_x, middle_y;
} Clusters;

/* First row at which the running sum reaches a share of the whole */
static Py_ssize_t draw(const Clusters *c, double luck)
{
    const double wanted = luck * c->edges[c->n - 1];
    Py_ssize_t begin = 0, end = c->n;
    while (begin < end) {
        Py_ssize_t middle = begin + (end - begin) / 2;
        if (c->edges[middle] < wanted)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin < c->n ? begin : c->n - 1;
}

/* Far from the seeds before in the mean, and heavy (k-means++) */
static void seed(Clusters *c)
{
    double sum = 0.0;
    for (Py_ssize_t i = 0; i < c->n; i++)
        c->edges[i] = sum += c->weight[i];
    for (Py_ssize_t k = 0;; k++) {
        const Py_ssize_t row = draw(c, c->luck[k]);
        const double x = c->centre_x[k] = c->x[row], y = c->centre_y[k] = c->y[row];
        if (k + 1 == c->k)
            return;
        sum = 0.0;
        for (Py_ssize_t i = 0; i < c->n; i++) {
            const double dx = c->x[i] - x, dy = c->y[i] - y, square = dx * dx + dy * dy;
            if (k == 0 || square < c->square[i])
                c->square[i] = square;
            c->edges[i] = sum += c->weight[i] * c->square[i] + LEAST_MASS;
        }
    }
}

/* From the middle of the centres, for the digits */
static void centre(Clusters *c)
{
    double x = c->centre_x[0], y = c->centre_y[0];
    for (Py_ssize_t k = 1; k < c->k; k++) {
        x += c->centre_x[k];
        y += c->centre_y[k];
    }
    c->middle_x = x / (double)c->k;
    c->middle_y = y / (double)c->k;
    for (Py_ssize_t k = 0; k < c->k; k++) {
        c->centre_x[k] -= c->middle_x;
        c->centre_y[k] -= c->middle_y;
    }
}

/* The nearest of the centres; returns whether any has changed. |x - c|^2 without |x|^2, which is
 * the same for all centres. */
static int find_nearest(Clusters *c)
{
    int changed = 0;
    for (Py_ssize_t i = 0; i < c->n; i++) {
        const double x = c->x[i] - c->middle_x, y = c->y[i] - c->middle_y;
        double nearest = 0.0;
        Row label = 0;
        for (Py_ssize_t k = 0; k < c->k; k++) {
            const double cx = c->centre_x[k], cy = c->centre_y[k];
            const double square = (-2.0 * cx * x + -2.0 * cy * y) + (cx * cx + cy * cy);
            if (k == 0 || square < nearest) {
                nearest = square;
                label = (Row)k;
            }
        }
        changed |= c->label[i] != label;
        c->label[i] = label;
    }
    return changed;
}

static void average(Clusters *c)
{
    for (Py_ssize_t k = 0; k < c->k; k++)
        c->mass[k] = c->sum_x[k] = c->sum_y[k] = 0.0;
    for (Py_ssize_t i = 0; i < c->n; i++) {
        const Row k = c->label[i];
        const double weight = c->weight[i];
        c->mass[k] += weight;
        c->sum_x[k] += weight * (c->x[i] - c->middle_x);
        c->sum_y[k] += weight * (c->y[i] - c->middle_y);
    }
    for (Py_ssize_t k = 0; k < c->k; k++)
        if (c->mass[k] > 0.0) {
            const double mass = c->mass[k] > LEAST_MASS ? c->mass[k] : LEAST_MASS;
            c->centre_x[k] = c->sum_x[k] / mass;
            c->centre_y[k] = c->sum_y[k] / mass;
        }
}

/* Rows of one cluster after the other */
static void arrange(Clusters *c)
{
    Row *next = (Row *)c->mass; /* of no use any more */
    for (Py_ssize_t k = 0; k < c->k; k++)
        c->counts[k] = 0;
    for (Py_ssize_t i = 0; i < c->n; i++)
        c->counts[c->label[i]]++;
    Row begins = 0;
    for (Py_ssize_t k = 0; k < c->k; k++) {
        next[k] = begins;
        begins += c->counts[k];
    }
    for (Py_ssize_t i = 0; i < c->n; i++)
        c->order[next[c->label[i]]++] = (Row)i;
}

static int run(Clusters *c, Py_ssize_t iterations)
{
    const size_t n = (size_t)c->n, k = (size_t)c->k;
    double *memory = malloc((2 * n + 5 * k) * sizeof(double));
    c->label = calloc(n, sizeof(Row));
    if (memory != NULL && c->label != NULL) {
        double *next = memory;
        c->edges = next, next += n;
        c->square = next, next += n;
        c->centre_x = next, next += k;
        c->centre_y = next, next += k;
        c->mass = next, next += k;
        c->sum_x = next, next += k;
        c->sum_y = next;
        seed(c);
        centre(c);
        find_nearest(c);
        for (Py_ssize_t step = 0; step < iterations; step++) {
            average(c);
            if (!find_nearest(c))
                break;
        }
        arrange(c);
    }
    const int failed = memory == NULL || c->label == NULL;
    free(memory);
    free(c->label);
    return failed;
}

PyDoc_STRVAR(cluster_doc,
"cluster(x, y, weight, luck, order, counts, iterations)\n--\n\n"
"Write rows of one cluster after the other, and how many each has: C-contiguous float64 and\n"
"int64; one number from 0 to 1 a cluster decides where it begins.");

static PyObject *cluster(PyObject *module, PyObject *arguments)
{
    Py_buffer b[6];
    Py_ssize_t iterations;
    Clusters c = {0};
    int failed = 0;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*w*w*n", &b[0], &b[1], &b[2], &b[3], &b[4], &b[5],
                          &iterations))
        return NULL;
    c.n = b[0].len / 8;
    c.k = b[3].len / 8;
    if (c.n < 1 || c.k < 1 || b[0].len % 8 || b[3].len % 8 || b[1].len != b[0].len ||
        b[2].len != b[0].len || b[4].len != b[0].len || b[5].len != b[3].len) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the same length, or none.");
    } else {
        c.x = b[0].buf, c.y = b[1].buf, c.weight = b[2].buf, c.luck = b[3].buf;
        c.order = b[4].buf, c.counts = b[5].buf;
        Py_BEGIN_ALLOW_THREADS
        failed = run(&c, iterations);
        Py_END_ALLOW_THREADS
        if (failed)
            PyErr_NoMemory();
    }
    for (int i = 0; i < 6; i++)
        PyBuffer_Release(&b[i]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef methods[] = {
    {"cluster", cluster, METH_VARARGS, cluster_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_clusters", "Weighted k-means, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_clusters(void)
{
    return PyModule_Create(&definition);
}
