/* forms.h - energy, forces and Hessian of a model, element by element, for tests and benches: no held copies, no
   constraints, no time. By the public functions of one deformation gradient. Vectors are copy_count x 3; an output may
   not overlap an input. Include after gxfem_solve.h. */
#ifndef BENCH_FORMS_H
#define BENCH_FORMS_H

#include <string.h>

/* sum of (x_i - x_0) (grad N_i)^T over the corners: exactly 0 for translations */
static inline void form_element_gradient(const gxs_element *element, const double *x, double gradient[9]) {
    int i, r, c;
    memset(gradient, 0, 9 * sizeof *gradient);
    for (i = 1; i < 4; i++)
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++)
                gradient[3 * r + c] +=
                    (x[3 * (size_t)element->copy[i] + (size_t)r] - x[3 * (size_t)element->copy[0] + (size_t)r]) *
                    element->gradient[i][c];
}

static inline void form_deformation(const gxs_element *element, const double *displacement, double deformation[9]) {
    form_element_gradient(element, displacement, deformation);
    deformation[0] += 1, deformation[4] += 1, deformation[8] += 1;
}

/* force += weight x P : grad N; the four add up to 0 but for rounding */
static inline void form_add_forces(const gxs_element *element, const double stress[9], double *force) {
    int i, r;
    for (i = 1; i < 4; i++)
        for (r = 0; r < 3; r++) {
            const double *p = stress + 3 * r, *g = element->gradient[i];
            const double share = element->weight * (p[0] * g[0] + p[1] * g[1] + p[2] * g[2]);
            force[3 * (size_t)element->copy[i] + (size_t)r] += share;
            force[3 * (size_t)element->copy[0] + (size_t)r] -= share;
        }
}

/* U, J */
static inline double form_energy(const gxs_model *model, const double *displacement) {
    double sum = 0, deformation[9];
    size_t e;
    for (e = 0; e < model->element_count; e++) {
        const gxs_element *element = &model->elements[e];
        form_deformation(element, displacement, deformation);
        sum += element->weight * gxs_material_energy(&model->materials[element->material], deformation);
    }
    return sum;
}

/* dU/du, N */
static inline void form_gradient(const gxs_model *model, const double *displacement, double *gradient) {
    double deformation[9], stress[9];
    size_t e;
    memset(gradient, 0, 3 * model->copy_count * sizeof *gradient);
    for (e = 0; e < model->element_count; e++) {
        const gxs_element *element = &model->elements[e];
        form_deformation(element, displacement, deformation);
        gxs_material_stress(&model->materials[element->material], deformation, stress);
        form_add_forces(element, stress, gradient);
    }
}

/* Projected Hessian of U at a displacement times direction, N; in single precision as the solver has it */
static inline void form_hessian_product(const gxs_model *model, const double *displacement, const double *direction,
                                        double *product) {
    double deformation[9], change[9], stress[9];
    size_t e;
    memset(product, 0, 3 * model->copy_count * sizeof *product);
    for (e = 0; e < model->element_count; e++) {
        const gxs_element *element = &model->elements[e];
        form_deformation(element, displacement, deformation);
        form_element_gradient(element, direction, change);
        gxs_material_product(&model->materials[element->material], deformation, change, stress);
        form_add_forces(element, stress, product);
    }
}

/* M, not lumped, times direction */
static inline void form_mass_product(const gxs_model *model, const double *direction, double *product) {
    static const int packed[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    size_t e, r;
    int i, j;
    memset(product, 0, 3 * model->copy_count * sizeof *product);
    for (e = 0; e < model->element_count; e++) {
        const gxs_element *element = &model->elements[e];
        for (i = 0; i < 4; i++)
            for (j = 0; j < 4; j++)
                for (r = 0; r < 3; r++)
                    product[3 * (size_t)element->copy[i] + r] +=
                        element->mass[packed[i][j]] * direction[3 * (size_t)element->copy[j] + r];
    }
}

#endif
