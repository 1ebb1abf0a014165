/* cell_moments.h - moments of a body's cells, by their mass matrices: what the solver's inertia is made of. Include
   after the implementation of gxfem.h and models.h. */
#ifndef GXFEM_TESTS_CELL_MOMENTS_H
#define GXFEM_TESTS_CELL_MOMENTS_H

/* A sum of thousands of terms to its last digits */
typedef struct long_sum {
    double sum, rest;
} long_sum;

static inline void add_to(long_sum *s, double x) {
    const double sum = s->sum + x, part = sum - s->sum;
    s->rest += (s->sum - (sum - part)) + (x - part);
    s->sum = sum;
}

/* Moments of the cells of a material by their mass matrices, about a place: the integrals of 1, x and x x times the
   density */
static inline exact_moments moments_of_cells(const gx_body *body, uint32_t material, const double about[3]) {
    long_sum sum[10];
    exact_moments m;
    uint32_t c;
    int i, j, k, l, n;
    memset(sum, 0, sizeof sum);
    for (c = 0; c < body->cells.count; c++) {
        const gxp_cell *cell = &body->cells.data[c];
        double x[12];
        int entry = 0;
        if (!cell->kept || cell->material != material) continue;
        gxp_element_positions(body, cell->element, x);
        for (i = 0; i < 12; i++) x[i] -= about[i % 3];
        for (i = 0; i < 4; i++)
            for (j = i; j < 4; j++, entry++) {
                const double mass = (i == j ? 1 : 2) * cell->mass[entry];
                add_to(&sum[0], mass);
                for (k = 0, n = 4; k < 3; k++) {
                    add_to(&sum[1 + k], mass * 0.5 * (x[3 * i + k] + x[3 * j + k]));
                    for (l = k; l < 3; l++, n++)
                        add_to(&sum[n], mass * 0.5 * (x[3 * i + k] * x[3 * j + l] + x[3 * j + k] * x[3 * i + l]));
                }
            }
    }
    m.volume = sum[0].sum + sum[0].rest;
    for (k = 0; k < 3; k++) m.first[k] = sum[1 + k].sum + sum[1 + k].rest;
    for (k = 0; k < 6; k++) m.second[k] = sum[4 + k].sum + sum[4 + k].rest;
    return m;
}

#endif /* GXFEM_TESTS_CELL_MOMENTS_H */
