/* Fixed-interval smoother of a linear system: linear_recursion.py, compiled.
 *
 * All operations are those of linear_recursion.py, the sums in their order, and none is contracted:
 * both give the same bits. What is multiplied by zero is not added.
 */

#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef Py_ssize_t count;

typedef struct {
    count times, rows, size;
    const double *transition, *noise, *matrix, *measured, *weight, *variance;
    double *mean, *covariance, *ahead_mean, *ahead, *backward, *roots, *squared;
} problem;

/* out = left right, shapes (n, m) and (m, p) */
static void product(const double *restrict left, const double *restrict right, count n, count m,
                    count p, double *restrict out)
{
    for (count i = 0; i < n; i++) {
        double *restrict own = out + i * p;
        for (count j = 0; j < p; j++)
            own[j] = left[i * m] * right[j];
        for (count k = 1; k < m; k++) {
            const double factor = left[i * m + k];
            const double *restrict row = right + k * p;
            for (count j = 0; j < p; j++)
                own[j] += factor * row[j];
        }
    }
}

/* The same of square matrices, the left one with few entries but zero: these are left out */
static void sparse_product(const double *restrict left, const double *restrict right, count n,
                           double *restrict out)
{
    for (count i = 0; i < n; i++) {
        double *restrict own = out + i * n;
        for (count j = 0; j < n; j++)
            own[j] = 0.0;
        for (count k = 0; k < n; k++) {
            const double factor = left[i * n + k];
            const double *restrict row = right + k * n;
            if (factor != 0.0)
                for (count j = 0; j < n; j++)
                    own[j] += factor * row[j];
        }
    }
}

/* out = matrix^T, shape (n, n) */
static void transpose(const double *restrict matrix, count n, double *restrict out)
{
    for (count i = 0; i < n; i++)
        for (count j = 0; j < n; j++)
            out[j * n + i] = matrix[i * n + j];
}

/* out = matrix row^T, shape (n,), of a row with few entries but zero; returns row out */
static double applied(const double *restrict matrix, const double *restrict row, count n,
                      double *restrict out)
{
    double sum = 0.0;
    for (count i = 0; i < n; i++)
        out[i] = 0.0;
    for (count k = 0; k < n; k++) {
        const double factor = row[k];
        if (factor != 0.0)
            for (count i = 0; i < n; i++)
                out[i] += matrix[i * n + k] * factor;
    }
    for (count k = 0; k < n; k++)
        if (row[k] != 0.0)
            sum += row[k] * out[k];
    return sum;
}

/* Sum of the products of a row, with few entries but zero, and a column */
static double inner_product(const double *restrict row, const double *restrict column, count n)
{
    double sum = 0.0;
    for (count k = 0; k < n; k++)
        if (row[k] != 0.0)
            sum += row[k] * column[k];
    return sum;
}

/* Lower Cholesky factor in place, row length n; returns whether there is one */
static int factorise(double *matrix, count n, count used)
{
    for (count j = 0; j < used; j++) {
        for (count k = 0; k < j; k++) {
            const double factor = matrix[j * n + k];
            for (count i = j; i < used; i++)
                matrix[i * n + j] -= matrix[i * n + k] * factor;
        }
        if (!(matrix[j * n + j] > 0.0))
            return 0;
        const double root = sqrt(matrix[j * n + j]);
        for (count i = j; i < used; i++)
            matrix[i * n + j] /= root;
        matrix[j * n + j] = root;
    }
    return 1;
}

/* Into each instant from the one before */
static void predict(const problem *all, count time, const double *state, const double *spread,
                    double *room)
{
    const count n = all->size, square = n * n;
    const double *transition = all->transition + time * square;
    const double *noise = all->noise + time * square;
    double *ahead = all->ahead + time * square;
    product(transition, state, n, n, 1, all->ahead_mean + time * n);
    double *turned = room + square;
    sparse_product(transition, spread, n, room);
    transpose(room, n, turned);
    sparse_product(transition, turned, n, room);
    transpose(room, n, ahead);
    for (count i = 0; i < square; i++)
        ahead[i] += noise[i];
}

/* How well what is measured agrees with the prediction: factor of its covariance, distance */
static int judge(const problem *all, count time, const count *there, count found, double *room)
{
    const count n = all->size, rows = all->rows;
    double *crossed = room, *inner = crossed + rows * n, *scaled = inner + rows * rows;
    const double *state = all->ahead_mean + time * n, *spread = all->ahead + time * n * n;
    for (count a = 0; a < found; a++) {
        const double *own = all->matrix + (time * rows + there[a]) * n;
        inner[a * rows + a] = applied(spread, own, n, crossed + a * n);
        for (count b = 0; b < a; b++) {
            const double *other = all->matrix + (time * rows + there[b]) * n;
            inner[a * rows + b] = inner_product(other, crossed + a * n, n);
        }
        inner[a * rows + a] += all->variance[time * rows + there[a]];
        scaled[a] = all->measured[time * rows + there[a]] - inner_product(own, state, n);
    }
    if (!factorise(inner, rows, found))
        return 0;
    double squared = 0.0;
    for (count a = 0; a < found; a++) {
        for (count b = 0; b < a; b++)
            scaled[a] -= inner[a * rows + b] * scaled[b];
        scaled[a] /= inner[a * rows + a];
        squared += scaled[a] * scaled[a];
        all->roots[time * rows + a] = inner[a * rows + a];
    }
    all->squared[time] = squared;
    return 1;
}

/* Take the rows in, one after the other */
static void update(const problem *all, count time, const count *there, count found,
                   double *restrict room)
{
    const count n = all->size;
    double *restrict state = all->mean + time * n;
    double *restrict spread = all->covariance + time * n * n;
    for (count a = 0; a < found; a++) {
        const count place = time * all->rows + there[a];
        const double *own = all->matrix + place * n;
        const double variance = applied(spread, own, n, room) + 1.0 / all->weight[place];
        const double step = (all->measured[place] - inner_product(own, state, n)) / variance;
        for (count i = 0; i < n; i++) {
            const double crossed = room[i];
            double *restrict remaining = spread + i * n;
            state[i] += crossed * step;
            for (count j = 0; j < n; j++)
                remaining[j] -= crossed * room[j] / variance;
        }
    }
}

/* row -= factor other */
static void take_off(double *restrict row, double factor, const double *restrict other, count n)
{
    for (count j = 0; j < n; j++)
        row[j] -= factor * other[j];
}

/* backward = (ahead^-1 forwards)^T of the instant before */
static int find_backward(const problem *all, count time, double *room)
{
    const count n = all->size, square = n * n;
    double *factor = room, *forwards = room + square, *backward = all->backward + (time - 1) * square;
    memcpy(factor, all->ahead + time * square, (size_t)square * sizeof(double));
    sparse_product(all->transition + time * square, all->covariance + (time - 1) * square, n,
                   forwards);
    if (!factorise(factor, n, n))
        return 0;
    for (count i = 0; i < n; i++) {
        for (count k = 0; k < i; k++)
            take_off(forwards + i * n, factor[i * n + k], forwards + k * n, n);
        for (count j = 0; j < n; j++)
            forwards[i * n + j] /= factor[i * n + i];
    }
    for (count i = n - 1; i >= 0; i--) {
        for (count k = i + 1; k < n; k++)
            take_off(forwards + i * n, factor[k * n + i], forwards + k * n, n);
        for (count j = 0; j < n; j++)
            forwards[i * n + j] /= factor[i * n + i];
    }
    transpose(forwards, n, backward);
    return 1;
}

/* What comes after an instant tells of it */
static void smooth_back(const problem *all, count time, double *room)
{
    const count n = all->size, square = n * n;
    const double *back = all->backward + time * square;
    double *difference = room, *moved = room + square, *change = moved + square;
    for (count i = 0; i < n; i++)
        difference[i] = all->mean[(time + 1) * n + i] - all->ahead_mean[(time + 1) * n + i];
    product(back, difference, n, n, 1, moved);
    for (count i = 0; i < n; i++)
        all->mean[time * n + i] += moved[i];
    for (count i = 0; i < square; i++)
        difference[i] =
            all->covariance[(time + 1) * square + i] - all->ahead[(time + 1) * square + i];
    product(back, difference, n, n, n, moved);
    transpose(back, n, difference);
    product(moved, difference, n, n, n, change);
    for (count i = 0; i < square; i++)
        all->covariance[time * square + i] += change[i];
}

/* 0, or one more than the instant that has no positive definite covariance */
static count run(const problem *all, const double *start, double *room, count *there)
{
    const count n = all->size, square = n * n;
    const double *state = start, *spread = start + n;
    for (count time = 0; time < all->times; time++) {
        count found = 0;
        predict(all, time, state, spread, room);
        memcpy(all->mean + time * n, all->ahead_mean + time * n, (size_t)n * sizeof(double));
        memcpy(all->covariance + time * square, all->ahead + time * square,
               (size_t)square * sizeof(double));
        for (count row = 0; row < all->rows; row++)
            if (all->weight[time * all->rows + row] != 0.0)
                there[found++] = row;
        if (!judge(all, time, there, found, room))
            return time + 1;
        update(all, time, there, found, room);
        state = all->mean + time * n;
        spread = all->covariance + time * square;
    }
    for (count time = 1; time < all->times; time++)
        if (!find_backward(all, time, room))
            return time + 1;
    for (count time = all->times - 2; time >= 0; time--)
        smooth_back(all, time, room);
    return 0;
}

PyDoc_STRVAR(smooth_doc,
"smooth(start, transition, noise, matrix, measured, weight, variance, mean, covariance,\n"
"       ahead_mean, ahead, backward, roots, squared, shape)\n--\n\n"
"Smooth a linear system: C-contiguous float64, shape = (instants, rows, size); start is its mean\n"
"and its covariance. Returns 0, or one more than the first instant without a positive definite\n"
"covariance.");

static PyObject *smooth(PyObject *module, PyObject *arguments)
{
    Py_buffer in[7], out[7];
    count times, rows, size;
    if (!PyArg_ParseTuple(arguments, "y*y*y*y*y*y*y*w*w*w*w*w*w*w*(nnn)", &in[0], &in[1], &in[2],
                          &in[3], &in[4], &in[5], &in[6], &out[0], &out[1], &out[2], &out[3],
                          &out[4], &out[5], &out[6], &times, &rows, &size))
        return NULL;
    const count square = size * size;
    const count expected_in[7] = {size + square,       times * square, times * square,
                                  times * rows * size, times * rows,   times * rows,
                                  times * rows};
    const count expected_out[7] = {times * size,          times * square, times * size,
                                   times * square,        (times - 1) * square,
                                   times * rows, times};
    int fits = times >= 1 && rows >= 0 && size >= 1;
    for (int i = 0; i < 7 && fits; i++)
        fits = in[i].len == expected_in[i] * (count)sizeof(double) &&
               out[i].len == expected_out[i] * (count)sizeof(double);
    count failed = 0;
    if (!fits) {
        PyErr_SetString(PyExc_ValueError, "The buffers do not have the stated shape.");
    } else {
        const count space = 3 * square + rows * size + rows * rows + rows + size;
        double *room = malloc((size_t)space * sizeof(double));
        count *there = malloc((size_t)(rows + 1) * sizeof(count));
        if (room == NULL || there == NULL) {
            PyErr_NoMemory();
        } else {
            const problem all = {times,      rows,       size,       in[1].buf,  in[2].buf,
                                 in[3].buf,  in[4].buf,  in[5].buf,  in[6].buf,  out[0].buf,
                                 out[1].buf, out[2].buf, out[3].buf, out[4].buf, out[5].buf,
                                 out[6].buf};
            Py_BEGIN_ALLOW_THREADS
            failed = run(&all, in[0].buf, room, there);
            Py_END_ALLOW_THREADS
        }
        free(room);
        free(there);
    }
    for (int i = 0; i < 7; i++) {
        PyBuffer_Release(&in[i]);
        PyBuffer_Release(&out[i]);
    }
    return PyErr_Occurred() ? NULL : PyLong_FromSsize_t(failed);
}

static PyMethodDef methods[] = {
    {"smooth", smooth, METH_VARARGS, smooth_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "compiled_linear", "Smoother of linear systems, compiled.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_compiled_linear(void)
{
    return PyModule_Create(&definition);
}
