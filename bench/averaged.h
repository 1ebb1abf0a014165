/* averaged.h - a trial: volume changes averaged over the cells of each node, against the locking of nearly
   incompressible linear elements [Bonet and Burton 1998]. Small strain only; no part of the library.

   U = sum over elements w mu e:e + sum over copies lambda/2 V_a t_a^2, where V_a is a quarter of the cells' weights and
   t_a = sum (w / 4) div u / V_a. Cells that a cut has left of elements take part by what is left of them.

   Include after gxfem_solve.h, forms.h and mesh.h. */
#ifndef BENCH_AVERAGED_H
#define BENCH_AVERAGED_H

typedef struct averaged {
    const gxs_model *model;
    const uint8_t *held;
    double mu, lambda; /* Pa */
    int on;            /* 0: each element by itself, as the library has it */
    double *volume;    /* copy_count: V_a */
    double *change;    /* copy_count: t_a */
} averaged;

/* y = K x on copies that are not held; x is 0 on the others. */
static void averaged_product(averaged *a, const double *x, double *y) {
    const gxs_model *m = a->model;
    double gradient[9], stress[9];
    size_t e, i;
    int k, r, c;
    memset(a->change, 0, m->copy_count * sizeof(double));
    memset(y, 0, 3 * m->copy_count * sizeof(double));
    for (e = 0; e < m->element_count; e++) {
        form_element_gradient(&m->elements[e], x, gradient);
        for (k = 0; k < 4; k++)
            a->change[m->elements[e].copy[k]] +=
                0.25 * m->elements[e].weight * (gradient[0] + gradient[4] + gradient[8]);
    }
    for (i = 0; i < m->copy_count; i++) a->change[i] /= a->volume[i] > 0 ? a->volume[i] : 1;
    for (e = 0; e < m->element_count; e++) {
        double change = 0;
        form_element_gradient(&m->elements[e], x, gradient);
        for (k = 0; k < 4; k++) change += 0.25 * a->change[m->elements[e].copy[k]];
        if (!a->on) change = gradient[0] + gradient[4] + gradient[8];
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++)
                stress[3 * r + c] =
                    a->mu * (gradient[3 * r + c] + gradient[3 * c + r]) + (r == c ? a->lambda * change : 0);
        form_add_forces(&m->elements[e], stress, y);
    }
    for (i = 0; i < 3 * m->copy_count; i++)
        if (a->held[i / 3]) y[i] = 0;
}

/* Solves K x = f to 1e-8 by conjugate gradients with the diagonal. Returns how many iterations that took. */
static size_t averaged_solve(averaged *a, const double *f, double *x) {
    const size_t n = 3 * a->model->copy_count;
    double *r = (double *)memory(5 * n, sizeof *r), *z = r + n, *p = z + n, *q = p + n, *inverse = q + n;
    double gain, next = 0, first = 0;
    size_t e, i, count;
    int k, c;
    for (e = 0; e < a->model->element_count; e++)
        for (k = 0; k < 4; k++) {
            const gxs_element *element = &a->model->elements[e];
            const double *g = element->gradient[k];
            a->volume[element->copy[k]] += 0.25 * element->weight;
            for (c = 0; c < 3; c++)
                inverse[3 * element->copy[k] + (size_t)c] +=
                    element->weight *
                    (a->mu * (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) + (a->lambda + a->mu) * g[c] * g[c]);
        }
    memset(x, 0, n * sizeof *x);
    for (i = 0; i < n; i++) {
        inverse[i] = a->held[i / 3] || !(inverse[i] > 0) ? 0 : 1 / inverse[i];
        r[i] = a->held[i / 3] ? 0 : f[i];
        p[i] = inverse[i] * r[i];
        first += r[i] * p[i];
    }
    for (count = 0, gain = first; gain > 1e-16 * first && count < 200000; count++) {
        double work = 0;
        averaged_product(a, p, q);
        for (i = 0; i < n; i++) work += p[i] * q[i];
        for (next = 0, i = 0; i < n; i++) {
            x[i] += gain / work * p[i];
            r[i] -= gain / work * q[i];
            z[i] = inverse[i] * r[i];
            next += r[i] * z[i];
        }
        for (i = 0; i < n; i++) p[i] = z[i] + next / gain * p[i];
        gain = next;
    }
    free(r);
    return count;
}

#endif
