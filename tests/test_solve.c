/* test_solve.c - tests of gxfem_solve.h: material, assembled forms, time step, violent starts, bad input, memory. */
#define GXFEM_SOLVE_IMPLEMENTATION
#include "../gxfem_solve.h"

#include "block.h"
#include "runner.h"
#include <fenv.h>
#include <pthread.h>
#include <stdio.h>

/* ---- material ---- */

static void random_deformation(double *f, double spread) {
    int k;
    for (k = 0; k < 9; k++) f[k] = (k % 4 == 0 ? 1 : 0) + spread * uniform();
}

static const double poissons[4] = {0, 0.3, 0.45, 0.4999};

static gxs_material material_make(int kind, double nu) {
    static gxs_material made[8]; /* those that are in use live no longer than eight */
    static int next;
    gxs_material *material = &made[next++ % 8];
    memset(material, 0, sizeof *material);
    material->young = 1;
    material->poisson = nu;
    set_kind(material, kind);
    return *material;
}

START_TEST(energy_is_the_formula_of_the_paper) {
    int round, k;
    for (round = 0; round < 1000; round++) {
        double f[9], nu = poissons[round % 4], mu, lambda, alpha, ic = 0, j, direct, rest, energy;
        gxs_material material = material_make(GXS_STABLE_NEO_HOOKEAN, nu);
        seed((uint64_t)round);
        random_deformation(f, 2);
        mu = 4.0 / 3 / (2 * (1 + nu));
        lambda = nu / ((1 + nu) * (1 - 2 * nu)) + 5.0 / 6 / (2 * (1 + nu));
        alpha = 1 + 0.75 * mu / lambda;
        for (k = 0; k < 9; k++) ic += f[k] * f[k];
        j = f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) +
            f[2] * (f[3] * f[7] - f[4] * f[6]);
        direct = 0.5 * mu * (ic - 3) + 0.5 * lambda * (j - alpha) * (j - alpha) - 0.5 * mu * log(ic + 1);
        rest = 0.5 * lambda * (1 - alpha) * (1 - alpha) - 0.5 * mu * log(4.0);
        energy = gxs_material_energy(&material, f);
        assert_that(fabs(energy - (direct - rest)) <= 1e-12 * (1 + fabs(direct) + lambda * (1 + j * j)), "%g %g",
                    energy, direct - rest);
    }
}
END_TEST

START_TEST(rest_and_rotations_are_free_of_stress) {
    static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    gxs_material material = material_make(_i, 0.4);
    double stress[9];
    int k, round;
    ck_assert(gxs_material_energy(&material, unit) < 1e-30);
    gxs_material_stress(&material, unit, stress);
    for (k = 0; k < 9; k++) ck_assert(fabs(stress[k]) < 1e-15);
    for (round = 0; round < 100 && _i != GXS_LINEAR; round++) {
        double q[4], length = 0, r[9];
        seed((uint64_t)round);
        for (k = 0; k < 4; k++) q[k] = uniform(), length += q[k] * q[k];
        for (k = 0; k < 4; k++) q[k] /= sqrt(length);
        r[0] = 1 - 2 * (q[2] * q[2] + q[3] * q[3]), r[1] = 2 * (q[1] * q[2] - q[0] * q[3]),
        r[2] = 2 * (q[1] * q[3] + q[0] * q[2]);
        r[3] = 2 * (q[1] * q[2] + q[0] * q[3]), r[4] = 1 - 2 * (q[1] * q[1] + q[3] * q[3]),
        r[5] = 2 * (q[2] * q[3] - q[0] * q[1]);
        r[6] = 2 * (q[1] * q[3] - q[0] * q[2]), r[7] = 2 * (q[2] * q[3] + q[0] * q[1]),
        r[8] = 1 - 2 * (q[1] * q[1] + q[2] * q[2]);
        gxs_material_stress(&material, r, stress);
        for (k = 0; k < 9; k++) assert_that(fabs(stress[k]) < 1e-13, "stress %g", stress[k]);
    }
}
END_TEST

/* P(1 + e) = 2 mu' e + lambda' tr(e) 1 in small strain, to all digits that a strain of 1e-9 allows */
START_TEST(small_strain_is_linear_elasticity) {
    int round, r, c;
    for (round = 0; round < 100; round++) {
        double f[9], stress[9], strain[9], nu = poissons[round % 4], shear = 1 / (2 * (1 + nu));
        double lame = nu / ((1 + nu) * (1 - 2 * nu)), trace;
        gxs_material material = material_make(_i, nu);
        seed((uint64_t)round);
        random_deformation(f, 1e-7);
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++) strain[3 * r + c] = 0.5 * (f[3 * r + c] + f[3 * c + r]) - (r == c ? 1 : 0);
        trace = strain[0] + strain[4] + strain[8];
        gxs_material_stress(&material, f, stress);
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++) {
                double expected = 2 * shear * strain[3 * r + c] + (r == c ? lame * trace : 0);
                assert_that(fabs(stress[3 * r + c] - expected) < 1e-12 * (1 + lame), "%g %g", stress[3 * r + c],
                            expected);
            }
    }
}
END_TEST

START_TEST(stress_is_the_derivative_of_energy) {
    int round, k;
    for (round = 0; round < 400; round++) {
        double f[9], stress[9], scale = 0;
        gxs_material material = material_make(_i, poissons[round % 4]);
        seed((uint64_t)round);
        /* Its rotation jumps where F is inverted. */
        random_deformation(f, round % 2 ? 0.3 : _i == GXS_FIXED_COROTATED ? 0.5 : 2);
        gxs_material_stress(&material, f, stress);
        for (k = 0; k < 9; k++) scale += fabs(stress[k]);
        for (k = 0; k < 9; k++) {
            double up[9], down[9], difference;
            memcpy(up, f, sizeof up);
            memcpy(down, f, sizeof down);
            up[k] += 1e-5, down[k] -= 1e-5;
            difference = (gxs_material_energy(&material, up) - gxs_material_energy(&material, down)) / 2e-5;
            assert_that(fabs(difference - stress[k]) < 1e-6 * (1 + scale), "%g %g", difference, stress[k]);
        }
    }
}
END_TEST

/* the 9x9 matrix of the product, by columns */
static void hessian(const gxs_material *material, const double *f, double h[9][9]) {
    int c;
    for (c = 0; c < 9; c++) {
        double direction[9] = {0};
        direction[c] = 1;
        gxs_material_product(material, f, direction, h[c]);
    }
}

/* smallest eigenvalue of a symmetric 9x9 by Jacobi; largest: its norm */
static double smallest_eigenvalue(double a[9][9], double *largest) {
    double least;
    int sweep, p, q, k;
    for (sweep = 0; sweep < 30; sweep++)
        for (p = 0; p < 9; p++)
            for (q = p + 1; q < 9; q++) {
                double theta, t, c, s;
                if (a[p][q] * a[p][q] <= 1e-40 * (a[p][p] * a[p][p] + a[q][q] * a[q][q])) continue;
                theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(1 + theta * theta));
                c = 1 / sqrt(1 + t * t), s = c * t;
                for (k = 0; k < 9; k++) {
                    double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
                }
                for (k = 0; k < 9; k++) {
                    double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
                }
            }
    least = *largest = a[0][0];
    for (k = 1; k < 9; k++) {
        least = a[k][k] < least ? a[k][k] : least;
        *largest = a[k][k] > *largest ? a[k][k] : *largest;
    }
    return least;
}

/* Hessian by differences of the stress, symmetrised */
static void difference_hessian(const gxs_material *material, const double *f, double h[9][9]) {
    int r, c;
    double raw[9][9];
    for (c = 0; c < 9; c++) {
        double up[9], down[9], p_up[9], p_down[9];
        memcpy(up, f, sizeof up);
        memcpy(down, f, sizeof down);
        up[c] += 1e-5, down[c] -= 1e-5;
        gxs_material_stress(material, up, p_up);
        gxs_material_stress(material, down, p_down);
        for (r = 0; r < 9; r++) raw[c][r] = (p_up[r] - p_down[r]) / 2e-5;
    }
    for (c = 0; c < 9; c++)
        for (r = 0; r < 9; r++) h[c][r] = 0.5 * (raw[c][r] + raw[r][c]);
}

/* Where the true Hessian has no negative eigenvalue, the product is the true one. Elsewhere the difference
   (projected - true) is semi-definite and has no part in the positive eigenspace, hence trace(projected x
   difference) = 0. */
START_TEST(hessian_is_the_projection_of_the_derivative_of_stress) {
    int round, r, c, same = 0, projected = 0;
    for (round = 0; round < 600; round++) {
        double f[9], h[9][9], d[9][9], copy[9][9], least, largest, trace = 0, error = 0;
        gxs_material material = material_make(_i, poissons[round % 4]);
        seed((uint64_t)round);
        random_deformation(f, round % 3 && _i != GXS_FIXED_COROTATED ? 1.5 : 0.15 + 0.2 * (round % 3));
        if (round % 3 == 0) /* stretched: where the Hessian is definite */
            for (r = 0; r < 9; r += 4) f[r] += 0.4;
        hessian(&material, f, h);
        difference_hessian(&material, f, d);
        memcpy(copy, d, sizeof copy);
        least = smallest_eigenvalue(copy, &largest);
        for (r = 0; r < 9; r++)
            for (c = 0; c < 9; c++) {
                d[r][c] = h[r][c] - d[r][c];
                trace += d[r][c] * h[r][c];
                error = fabs(d[r][c]) > error ? fabs(d[r][c]) : error;
            }
        assert_that(fabs(trace) < 2e-5 * (largest * largest), "trace %g largest %g", trace, largest);
        if (least > 1e-5 * largest || _i == GXS_LINEAR) {
            assert_that(error < 1e-5 * (1 + largest), "error %g largest %g", error, largest);
            same++;
        } else {
            memcpy(copy, d, sizeof copy);
            least = smallest_eigenvalue(copy, &error);
            assert_that(least > -1e-5 * (1 + largest), "least %g largest %g", least, largest);
            projected++;
        }
    }
    ck_assert_int_gt(same, 50);
    ck_assert_int_gt(projected + (_i == GXS_LINEAR ? 100 : 0), 50);
}
END_TEST

/* to single precision */
static void check_semidefinite(const gxs_material *material, const double *f) {
    double h[9][9], largest, least, asymmetry = 0;
    int r, c;
    hessian(material, f, h);
    for (r = 0; r < 9; r++)
        for (c = 0; c < 9; c++) {
            assert_that(finite_bits(h[r][c]), "not finite");
            asymmetry = fabs(h[r][c] - h[c][r]) > asymmetry ? fabs(h[r][c] - h[c][r]) : asymmetry;
        }
    least = smallest_eigenvalue(h, &largest);
    assert_that(largest >= 0 && least >= -2e-6 * largest && asymmetry <= 2e-6 * largest, "%g %g %g", least, largest,
                asymmetry);
}

/* random, squeezed, inverted, flattened to a plane or a line, collapsed to a point, nearly so, huge */
START_TEST(projected_hessian_is_semidefinite) {
    static const double factors[7] = {1, 0, -1, 1e-3, -1e-8, 1e-160, 1e3};
    int round, a, b, c, k;
    for (a = 0; a < 7; a++)
        for (b = 0; b < 7; b++)
            for (c = 0; c < 7; c++)
                for (round = 0; round < 8; round++) {
                    double f[9], scale[3];
                    gxs_material material = material_make(_i, poissons[round % 4]);
                    scale[0] = factors[a], scale[1] = factors[b], scale[2] = factors[c];
                    seed((uint64_t)(((a * 7 + b) * 7 + c) * 8 + round));
                    random_deformation(f, round < 2 ? 0 : 1);
                    for (k = 0; k < 9; k++) f[k] *= scale[k % 3];
                    check_semidefinite(&material, f);
                }
}
END_TEST

/* ---- assembled forms ---- */

START_TEST(model_gradient_and_hessian_match_differences) {
    size_t i, n;
    double *d, *g, *h, *up, *gu, *gd, energy_up, energy_down, slope = 0, worst = 0, size = 0;
    scene s;
    seed(7);
    s = scene_block(2, 2, 2, 0.5, 0.1, 0);
    n = 3 * s.model.copy_count;
    d = (double *)zeroed(n, sizeof *d), g = (double *)zeroed(n, sizeof *d), h = (double *)zeroed(n, sizeof *d);
    up = (double *)zeroed(n, sizeof *d), gu = (double *)zeroed(n, sizeof *d), gd = (double *)zeroed(n, sizeof *d);
    for (i = 0; i < n; i++) { /* stretched a little, so that no Hessian needs projection */
        s.displacement[i] = 0.08 * s.rest[i] + 0.003 * uniform();
        d[i] = uniform();
    }
    form_gradient(&s.model, s.displacement, g);
    form_hessian_product(&s.model, s.displacement, d, h);
    for (i = 0; i < n; i++) up[i] = s.displacement[i] + 1e-5 * d[i], slope += g[i] * d[i];
    energy_up = form_energy(&s.model, up);
    form_gradient(&s.model, up, gu);
    for (i = 0; i < n; i++) up[i] = s.displacement[i] - 1e-5 * d[i];
    energy_down = form_energy(&s.model, up);
    form_gradient(&s.model, up, gd);
    assert_that(fabs((energy_up - energy_down) / 2e-5 - slope) < 1e-6 * fabs(slope), "slope %g", slope);
    for (i = 0; i < n; i++) {
        double error = fabs((gu[i] - gd[i]) / 2e-5 - h[i]);
        worst = error > worst ? error : worst;
        size = fabs(h[i]) > size ? fabs(h[i]) : size;
    }
    assert_that(worst < 3e-6 * size, "%g of %g", worst, size);
    free(d), free(g), free(h), free(up), free(gu), free(gd);
    scene_free(&s);
}
END_TEST

/* The chunks' product and block diagonal against the assembled forms: whole and cut elements, an incomplete last
   block */
START_TEST(block_product_equals_assembled_forms) {
    size_t i, n, k, copies;
    double *x, *expected, *mass, *product;
    gxsp_vector4 *in, *out;
    gxs_solver *solver = NULL;
    gxsp_system *system;
    scene s;
    const double rate = 2500;
    gxs_solver_desc desc;
    int collapsed;
    memset(&desc, 0, sizeof desc);
    desc.matrix = _i / 2 % 2 ? GXS_MATRIX_ASSEMBLED : GXS_MATRIX_FREE;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    seed(11);
    s = scene_block(9, 8, 4, 0.5, 0.1, 0);
    s.model.element_count -= 3;
    s.model.lumped_mass = _i % 2;
    set_kind(s.material, _i / 4);
    for (i = 0; i < 300; i++) {
        s.elements[i].weight *= 0.3;
        s.elements[i].mass[i % 10] *= 1.01; /* no longer the mass of a whole element */
        for (k = 0; k < 12 && i % 3 == 0; k++)
            s.elements[i].gradient[k / 3][k % 3] *= 1.02; /* nor the gradient by its corners' positions */
    }
    copies = s.model.copy_count;
    n = 3 * copies;
    x = (double *)zeroed(n, sizeof *x), expected = (double *)zeroed(n, sizeof *x),
    mass = (double *)zeroed(n, sizeof *x);
    product = (double *)zeroed(n, sizeof *x);
    in = (gxsp_vector4 *)zeroed(copies, sizeof *in), out = (gxsp_vector4 *)zeroed(copies, sizeof *out);
    for (i = 0; i < n; i++) {
        s.displacement[i] = 0.3 * uniform();
        in[i / 3][i % 3] = (float)uniform();
        x[i] = (double)in[i / 3][i % 3];
    }
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    system = solver->system;
    ck_assert(gxsp_linearise(system, rate, s.displacement, 0, &collapsed));
    if (desc.matrix == GXS_MATRIX_ASSEMBLED) gxsp_assemble(system, system->model.scale * rate);
    gxsp_product(system, rate, in, out);
    ck_assert_int_eq(gxs_solver_linearise(solver, s.displacement, rate, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(solver, x, product, NULL), GX_OK);
    form_hessian_product(&s.model, s.displacement, x, expected);
    form_mass_product(&s.model, x, mass);
    for (i = 0; i < n; i++) {
        double sum = expected[i] + rate * (s.model.lumped_mass ? system->model.lumped[i / 3] * x[i] : mass[i]);
        double got = (double)out[i / 3][i % 3] / system->model.scale;
        assert_that(fabs(got - sum) < 4e-6 * (1e6 + fabs(sum)), "%g %g", got, sum);
        assert_that(fabs(product[i] - sum) < 4e-6 * (1e6 + fabs(sum)), "%g %g", product[i], sum);
    }
    ck_assert(gxsp_linearise(system, rate, s.displacement, 0, &collapsed));
    for (i = 0; i < copies; i += 7)
        for (k = 0; k < 3; k++) { /* D^-1 times column k of D is a unit vector */
            float unit[3];
            size_t r;
            if (system->model.fixed[i]) continue;
            memset(in, 0, copies * sizeof *in);
            in[i][k] = 1;
            gxsp_product(system, rate, in, out);
            gxsp_apply_packed(system->vectors.diagonal + 6 * i, out[i], unit);
            for (r = 0; r < 3; r++) assert_that(fabs((double)unit[r] - (r == k ? 1 : 0)) < 1e-3, "%g", (double)unit[r]);
        }
    free(x), free(expected), free(mass), free(product), free(in), free(out);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- the operator of the interface ---- */

static double inner(const double *a, const double *b, size_t n) {
    double sum = 0;
    size_t i;
    for (i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static double largest(const double *a, size_t n) {
    double most = 0;
    size_t i;
    for (i = 0; i < n; i++) most = fabs(a[i]) > most ? fabs(a[i]) : most;
    return most;
}

/* Exact, in a state that would be projected: the difference quotient of the gradient. At rest, projected and exact
   are the same. */
START_TEST(operator_is_the_derivative_of_forces) {
    gxs_solver *solver = solver_make();
    size_t i, n;
    double *x, *y, *up, *down, *force[2];
    int rest, k;
    scene s;
    seed((uint64_t)_i);
    s = scene_block(3, 3, 2, 0.5, 0.1, 0);
    n = 3 * s.model.copy_count;
    x = (double *)zeroed(n, sizeof *x), y = (double *)zeroed(n, sizeof *x);
    up = (double *)zeroed(n, sizeof *x), down = (double *)zeroed(n, sizeof *x);
    force[0] = (double *)zeroed(n, sizeof *x), force[1] = (double *)zeroed(n, sizeof *x);
    set_kind(s.material, _i);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (rest = 0; rest < 2; rest++)
        for (k = 0; k < 1 + rest; k++) { /* exact; at rest projected too */
            for (i = 0; i < n; i++) {
                s.displacement[i] = rest ? 0 : -0.25 * s.rest[i] + 0.02 * uniform();
                x[i] = uniform();
                up[i] = s.displacement[i] + 1e-6 * x[i], down[i] = s.displacement[i] - 1e-6 * x[i];
            }
            ck_assert_int_eq(gxs_solver_linearise(solver, s.displacement, 0, k == 0, NULL), GX_OK);
            ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
            form_gradient(&s.model, up, force[0]);
            form_gradient(&s.model, down, force[1]);
            for (i = 0; i < n; i++) {
                const double expected = (force[0][i] - force[1][i]) / 2e-6;
                assert_that(fabs(y[i] - expected) < 1e-5 * largest(y, n), "%s: %g %g", rest ? "at rest" : "compressed",
                            y[i], expected);
            }
        }
    free(x), free(y), free(up), free(down), free(force[0]), free(force[1]);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Elements that share no copy: those of a chunk then have more nodes than a pass copies at once. The same 64 elements
   again and again, at the same place. */
enum { LOOSE = 64 };

static scene loose_elements(size_t count) {
    static const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    scene s;
    size_t e, i, k;
    memset(&s, 0, sizeof s);
    s.material = (gxs_material *)zeroed(1, sizeof *s.material);
    s.elements = (gxs_element *)zeroed(count, sizeof *s.elements);
    s.held = (uint8_t *)zeroed(4 * count, 1);
    s.rest = (double *)zeroed(12 * count, sizeof(double));
    s.displacement = (double *)zeroed(12 * count, sizeof(double));
    s.velocity = (double *)zeroed(12 * count, sizeof(double));
    s.forces = (double *)zeroed(12 * count, sizeof(double));
    s.material->young = 1e5;
    s.material->poisson = 0.4;
    for (e = 0; e < count; e++) {
        if (e % LOOSE == 0) seed(3);
        for (i = 0; i < 4; i++) {
            s.elements[e].copy[i] = (uint32_t)(4 * e + i);
            for (k = 0; k < 3; k++) {
                s.rest[12 * e + 3 * i + k] =
                    3 * (double)(e % LOOSE % 8 * (k == 0) + e % LOOSE / 8 * (k == 1)) + corner[i][k] + 0.1 * uniform();
                s.displacement[12 * e + 3 * i + k] = 0.1 * uniform();
                s.velocity[12 * e + 3 * i + k] = uniform();
                s.forces[12 * e + 3 * i + k] = uniform();
            }
        }
        make_element(&s.elements[e], s.rest, 1000);
    }
    s.model.copy_count = 4 * count;
    s.model.positions = s.rest;
    s.model.elements = s.elements;
    s.model.element_count = count;
    s.model.materials = s.material;
    s.model.material_count = 1;
    s.model.held = s.held;
    return s;
}

/* What each of LOOSE elements does does not depend on how many others there are. _i: 0, 1: gradients are made from
   positions or given; 2: an explicit step */
START_TEST(chunks_of_many_nodes) {
    double *product[2];
    scene s[2];
    gxs_solver *solver[2];
    gxs_step_desc step;
    gxs_step_report report[2];
    size_t i, side;
    memset(&step, 0, sizeof step);
    step.dt = 1e-3;
    step.newton_iterations = 8;
    step.cg_tolerance = 1e-6;
    if (_i == 2) step.integrator = GXS_EXPLICIT;
    for (side = 0; side < 2; side++) {
        s[side] = loose_elements(side == 0 ? LOOSE : 6 * LOOSE);
        if (_i == 1) /* another gradient than that of the positions, by its last bits */
            for (i = 0; i < s[side].model.element_count; i++) s[side].elements[i].gradient[2][1] *= 1 + 1e-9;
        solver[side] = solver_make();
        product[side] = (double *)zeroed(3 * s[side].model.copy_count, sizeof(double));
        ck_assert_int_eq(gxs_solver_set_model(solver[side], &s[side].model, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_linearise(solver[side], s[side].displacement, 1e4, 0, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_product(solver[side], s[side].forces, product[side], NULL), GX_OK);
        ck_assert_int_eq(
            gxs_solver_step(solver[side], &step, s[side].displacement, s[side].velocity, &report[side], NULL), GX_OK);
    }
    ck_assert_uint_eq(solver[0]->system->mesh.chunks[0].node_count, 4 * LOOSE); /* below GXSP_NEAR */
    ck_assert_uint_eq(solver[1]->system->mesh.chunks[0].node_count, 24 * LOOSE);
    ck_assert(report[0].substeps == report[1].substeps && (report[0].substeps > 0) == (_i == 2));
    for (i = 0; i < 12 * LOOSE; i++) {
        ck_assert(product[0][i] == product[1][i]);
        assert_that(fabs(s[0].displacement[i] - s[1].displacement[i]) <= 1e-9, "%zu: %.17g %.17g", i,
                    s[0].displacement[i], s[1].displacement[i]);
        if (_i == 2) ck_assert(s[0].displacement[i] == s[1].displacement[i] && s[0].velocity[i] == s[1].velocity[i]);
    }
    for (side = 0; side < 2; side++) {
        gxs_solver_destroy(solver[side]);
        scene_free(&s[side]);
        free(product[side]);
    }
}
END_TEST

/* Masters' motion to followers, and followers' forces to masters */
static void follow(const gxs_constraint *ties, size_t count, double *x) {
    size_t t, k;
    for (t = 0; t < 3 * count; t++) {
        const gxs_constraint *tie = &ties[t / 3];
        for (x[3 * tie->copy + t % 3] = 0, k = 0; k < 4; k++)
            x[3 * tie->copy + t % 3] += tie->weight[k] * x[3 * tie->master[k] + t % 3];
    }
}

static void give(const gxs_constraint *ties, size_t count, double *y) {
    size_t t, k;
    for (t = 0; t < 3 * count; t++) {
        const gxs_constraint *tie = &ties[t / 3];
        for (k = 0; k < 4; k++) y[3 * tie->master[k] + t % 3] += tie->weight[k] * y[3 * tie->copy + t % 3];
        y[3 * tie->copy + t % 3] = 0;
    }
}

/* Falling bodies, and bodies nearly at rest, have tiny rotations and strains. None of their powers may be denormal
   in single precision: that would make products take twice as long. */
START_TEST(small_strains_are_not_denormal) {
    static const double rate = 900;
    double size; /* m */
    scene s;
    gxs_solver *solver = NULL;
    gxsp_vector4 *in, *out;
    size_t i, n;
    int collapsed;
    seed(3);
    s = scene_block(5, 4, 3, 0.5, 0.1, 1);
    set_kind(s.material, _i);
    n = s.model.copy_count;
    for (i = 0; i < s.model.element_count; i += 3)
        s.elements[i].mass[i % 10] *= 1.01; /* no longer the mass of a whole element */
    in = (gxsp_vector4 *)zeroed(n, sizeof *in), out = (gxsp_vector4 *)zeroed(n, sizeof *out);
    ck_assert_int_eq(gxs_solver_create(NULL, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (size = 1e-25; size < 1; size *= 30) {
        for (i = 0; i < 3 * n; i++) {
            s.displacement[i] = size * uniform();
            in[i / 3][i % 3] = (float)uniform();
        }
        feclearexcept(FE_ALL_EXCEPT);
        ck_assert(gxsp_linearise(solver->system, rate, s.displacement, 0, &collapsed));
        assert_that(!fetestexcept(FE_UNDERFLOW), "linearised at displacements of %g", size);
        gxsp_product(solver->system, rate, in, out);
        assert_that(!fetestexcept(FE_UNDERFLOW), "product at displacements of %g", size);
    }
    free(in), free(out);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Held copies, followers of free and held ones, a copy without an element; far from rest. Checked: entries that must
   not be read, the result, symmetry. */
START_TEST(operator_acts_on_what_can_move) {
    /* clang-format off */
    static const gxs_constraint ties[3] = {{30, {31, 37, 31, 31}, {0.5, 0.5, 0, 0}},
                                           {41, {0, 47, 36, 53}, {0.25, 0.25, 0.25, 0.25}},
                                           {8, {0, 0, 0, 0}, {1, 0, 0, 0}}};
    /* clang-format on */
    const int kind = _i / 4, lumped = _i / 2 % 2;
    const double rate = 900;
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    size_t i, n;
    double *x, *z, *y, *w, *expected, *mass;
    scene s;
    memset(&desc, 0, sizeof desc);
    desc.matrix = _i % 2 ? GXS_MATRIX_ASSEMBLED : GXS_MATRIX_FREE;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    seed((uint64_t)_i);
    s = scene_block(5, 4, 3, 0.5, 0.1, 1);
    s.model.copy_count++;
    for (i = 0; i < s.model.copy_count; i++) s.held[i] = i % 6 == 0;
    s.held[30] = 0;
    n = 3 * s.model.copy_count;
    set_kind(s.material, kind);
    s.model.lumped_mass = (uint32_t)lumped;
    s.model.constraints = ties;
    s.model.constraint_count = 3;
    for (i = 0; i < 40; i++) s.elements[3 * i].mass[i % 10] *= 1.01;
    x = (double *)zeroed(n, sizeof *x), y = (double *)zeroed(n, sizeof *x), z = (double *)zeroed(n, sizeof *x),
    w = (double *)zeroed(n, sizeof *x);
    expected = (double *)zeroed(n, sizeof *x), mass = (double *)zeroed(n, sizeof *x);
    for (i = 0; i < n; i++) s.displacement[i] = 0.2 * uniform(), x[i] = uniform(), z[i] = uniform();
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_linearise(solver, s.displacement, rate, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(solver, z, w, NULL), GX_OK);
    assert_that(fabs(inner(x, w, n) - inner(z, y, n)) < 1e-6 * sqrt(inner(x, y, n) * inner(z, w, n)), "%g %g",
                inner(x, w, n), inner(z, y, n));
    for (i = 0; i < n; i++)
        x[i] = s.held[i / 3] || i / 3 == 30 || i / 3 == 41 || i / 3 == 8 || i == n - 1 ? 1e6 * uniform() : x[i];
    ck_assert_int_eq(gxs_solver_product(solver, x, w, NULL), GX_OK);
    for (i = 0; i < n; i++) /* another power of two by which it is scaled */
        assert_that(fabs(w[i] - y[i]) < 1e-5 * largest(y, n), "%g %g", w[i], y[i]);
    for (i = 0; i < n; i++) x[i] = s.held[i / 3] ? 0 : x[i];
    follow(ties, 3, x);
    form_hessian_product(&s.model, s.displacement, x, expected);
    form_mass_product(&s.model, x, mass);
    for (i = 0; i < n; i++) expected[i] += rate * (lumped ? solver->system->model.lumped[i / 3] * x[i] : mass[i]);
    give(ties, 3, expected);
    for (i = 0; i < n; i++) {
        const int still = s.held[i / 3] || i / 3 == 30 || i / 3 == 41 || i / 3 == 8 || i >= n - 3;
        assert_that(still ? y[i] == 0 : fabs(y[i] - expected[i]) < 4e-6 * largest(y, n), "%lu: %g %g", (unsigned long)i,
                    y[i], expected[i]);
    }
    free(x), free(y), free(z), free(w), free(expected), free(mass);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Translations meet no stiffness, a power of two is a factor, tiny and huge directions lose nothing, no direction
   has negative energy. */
START_TEST(operator_is_linear_and_semidefinite) {
    gxs_solver *solver = solver_make();
    size_t i, n;
    double *x, *y, *z, slope;
    int round;
    scene s;
    seed((uint64_t)_i);
    s = scene_block(4, 3, 3, 0.5, 0.1, 0);
    n = 3 * s.model.copy_count;
    x = (double *)zeroed(n, sizeof *x), y = (double *)zeroed(n, sizeof *x), z = (double *)zeroed(n, sizeof *x);
    set_kind(s.material, _i);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (round = 0; round < 20; round++) {
        for (i = 0; i < n; i++)
            s.displacement[i] = 0.05 * round * uniform(), x[i] = 3.7 * (double)(i % 3) - 1.234567890123;
        ck_assert_int_eq(gxs_solver_linearise(solver, s.displacement, 0, 0, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
        for (i = 0; i < n; i++) ck_assert(y[i] == 0);
        for (i = 0; i < n; i++) x[i] = uniform();
        ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
        slope = inner(x, y, n);
        assert_that(slope > -1e-6 * sqrt(inner(x, x, n) * inner(y, y, n)), "%g", slope);
        for (i = 0; i < n; i++) x[i] = ldexp(x[i], round % 2 ? 900 : -900);
        ck_assert_int_eq(gxs_solver_product(solver, x, z, NULL), GX_OK);
        for (i = 0; i < n; i++) ck_assert(z[i] == ldexp(y[i], round % 2 ? 900 : -900));
    }
    memset(x, 0, n * sizeof *x);
    ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
    ck_assert(largest(y, n) == 0);
    free(x), free(y), free(z);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* How long a linearisation lasts, and bad input. Steps are the same with a linearisation between them, of a damped
   material too. */
START_TEST(operator_lasts_until_the_next_step) {
    gxs_solver *solver = solver_make(), *other = solver_make();
    gxs_step_desc step = step_make(0.01, -9.81);
    gx_failure failure;
    size_t i, n;
    double *x, *y, *moved[2], nan = not_a_number(0);
    int frame;
    scene s;
    seed(5);
    s = scene_block(6, 6, 6, 0.25, 0.1, 0);
    scene_hold_left(&s);
    s.material->damping = 0.01;
    n = 3 * s.model.copy_count;
    x = (double *)zeroed(n, sizeof *x), y = (double *)zeroed(n, sizeof *x);
    moved[0] = (double *)zeroed(n, sizeof *x), moved[1] = (double *)zeroed(n, sizeof *x);
    for (i = 0; i < n; i++) x[i] = 0.1 * uniform();
    ck_assert_int_eq(gxs_solver_linearise(NULL, x, 0, 0, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxs_solver_linearise(solver, x, 0, 0, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gxs_solver_product(NULL, x, y, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(other, &s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_ERROR_SEQUENCE);
    for (frame = 0; frame < 6; frame++) {
        ck_assert_int_eq(gxs_solver_step(other, &step, moved[0], moved[1], NULL, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        ck_assert(memcmp(moved[0], s.displacement, n * sizeof *x) == 0 &&
                  memcmp(moved[1], s.velocity, n * sizeof *x) == 0);
        ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_ERROR_SEQUENCE);
        ck_assert_int_eq(gxs_solver_linearise(solver, x, 100, frame % 2 > 0, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
    }
    ck_assert_int_eq(gxs_solver_linearise(solver, x, -1, 0, &failure), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxs_solver_linearise(solver, x, nan, 0, &failure), GX_ERROR_NOT_FINITE);
    ck_assert_int_eq(gxs_solver_linearise(solver, NULL, 0, 0, &failure), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxs_solver_product(solver, NULL, y, &failure), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxs_solver_product(solver, x, NULL, &failure), GX_ERROR_ARGUMENT);
    memcpy(moved[0], y, n * sizeof *y);
    x[7] = not_a_number(1);
    ck_assert_int_eq(gxs_solver_product(solver, x, y, &failure), GX_ERROR_NOT_FINITE);
    ck_assert_uint_eq(failure.index, 2);
    ck_assert_int_eq(gxs_solver_linearise(solver, x, 0, 0, &failure), GX_ERROR_NOT_FINITE);
    ck_assert_uint_eq(failure.index, 2);
    ck_assert(memcmp(moved[0], y, n * sizeof *y) == 0); /* and the linearisation is still there */
    x[7] = 1e200;
    ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_linearise(solver, x, 0, 0, &failure), GX_ERROR_RANGE);
    ck_assert_int_eq(gxs_solver_product(solver, x, y, NULL), GX_ERROR_SEQUENCE);
    free(x), free(y), free(moved[0]), free(moved[1]);
    gxs_solver_destroy(solver);
    gxs_solver_destroy(other);
    scene_free(&s);
}
END_TEST

/* ---- step ---- */

/* Two loose bodies and a copy of none: u = v h + g h^2 exactly, with no linear iteration. */
START_TEST(free_fall_is_exact) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(1.0 / 30, -9.81);
    gxs_step_report report;
    size_t i, base;
    int frame;
    scene s;
    seed(3);
    s = scene_block(3, 2, 2, 0.25, 0.1, 8);
    base = s.model.copy_count;
    s.elements[s.model.element_count] = s.elements[0]; /* a loose tetrahedron of 1e-12 of its volume */
    for (i = 0; i < 4; i++) s.elements[s.model.element_count].copy[i] = (uint32_t)(base + i);
    s.elements[s.model.element_count].weight *= 1e-12;
    for (i = 0; i < 10; i++) s.elements[s.model.element_count].mass[i] *= 1e-12;
    s.model.element_count++;
    s.model.copy_count += 5;
    for (i = 0; i < base + 4; i++) s.velocity[3 * i] = i < base ? 2 : -1;
    for (frame = 0; frame < 10; frame++) {
        double t = (frame + 1) * step.dt;
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        ck_assert_uint_eq(report.cg_iterations, 0);
        for (i = 0; i < base + 4; i++) {
            assert_that(fabs(s.displacement[3 * i] - (i < base ? 2 : -1) * t) < 1e-14, "%g", s.displacement[3 * i]);
            assert_that(fabs(s.velocity[3 * i + 2] + 9.81 * t) < 1e-12, "%g", s.velocity[3 * i + 2]);
        }
        for (i = 3 * (base + 4); i < 3 * (base + 5); i++) ck_assert(s.displacement[i] == 0 && s.velocity[i] == 0);
    }
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Momentum is right to rounding, at a CG tolerance of 1e-1 and in violent motion; with forces: their impulse */
START_TEST(momentum_of_a_free_body_is_balanced) {
    gxs_solver *solver = solver_make();
    int frame, loaded;
    size_t i;
    for (loaded = 0; loaded < 2; loaded++) {
        gxs_step_desc step = step_make(0.01, 0);
        double before[3], after[3], impulse[3] = {0, 0, 0};
        scene s;
        seed(5);
        s = scene_block(3, 3, 3, 0.2, 0.1, 0);
        for (i = 0; i < 3 * s.model.copy_count; i++) {
            s.velocity[i] = 5 * uniform();
            s.forces[i] = loaded ? 100 * uniform() : 0;
            impulse[i % 3] += step.dt * s.forces[i];
        }
        step.forces = s.forces;
        step.cg_tolerance = 0.1;
        for (frame = 0; frame < 10; frame++) {
            momentum(&s, before);
            ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
            momentum(&s, after);
            for (i = 0; i < 3; i++)
                assert_that(fabs(after[i] - before[i] - impulse[i]) < 1e-10, "%g", after[i] - before[i] - impulse[i]);
        }
        scene_free(&s);
    }
    gxs_solver_destroy(solver);
}
END_TEST

/* nodal forces of a traction along x on the faces at x = 0 (pulled to the left) and x = length */
static void pull(scene *s, double length, double traction) {
    size_t e;
    int skip, k, r;
    for (e = 0; e < s->model.element_count; e++)
        for (skip = 0; skip < 4; skip++) {
            const double *x[3];
            uint32_t c[3];
            double a[3], b[3], area;
            int count = 0;
            for (k = 0; k < 4; k++)
                if (k != skip) {
                    c[count] = s->elements[e].copy[k];
                    x[count] = s->rest + 3 * c[count];
                    count++;
                }
            for (r = 0; r < 3; r++) a[r] = x[1][r] - x[0][r], b[r] = x[2][r] - x[0][r];
            area = 0.5 * fabs(a[1] * b[2] - a[2] * b[1]);
            for (k = 0; k < 3; k++) {
                if (x[0][0] == 0 && x[1][0] == 0 && x[2][0] == 0) s->forces[3 * c[k]] -= traction * area / 3;
                if (x[0][0] == length && x[1][0] == length && x[2][0] == length)
                    s->forces[3 * c[k]] += traction * area / 3;
            }
        }
}

START_TEST(stretched_bar_has_youngs_modulus) {
    int which;
    for (which = 0; which < 3; which++) {
        gxs_solver *solver = solver_make();
        gxs_step_desc step = step_make(1, 0);
        gxs_step_report report;
        scene s = scene_block(6, 2, 2, 0.5, 0, 0);
        double strain, across, expected = 1e-6;
        size_t last = s.model.copy_count - 1;
        int frame;
        s.material->poisson = which == 2 ? 0.49 : 0.3 * which;
        pull(&s, 3, expected * s.material->young);
        step.forces = s.forces;
        step.newton_iterations = 20;
        step.newton_tolerance = 1e-10;
        step.cg_tolerance = 1e-6;
        step.cg_iterations = 5000;
        for (frame = 0; frame < 3; frame++)
            ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        strain = (s.displacement[3 * last] - s.displacement[0]) / 3;
        across = s.displacement[3 * last + 1] - s.displacement[1];
        assert_that(report.residual < 1e-8, "residual %g", report.residual);
        assert_that(fabs(strain / expected - 1) < 1e-5, "strain %g", strain);
        assert_that(fabs(across + s.material->poisson * expected) < 1e-5 * expected, "across %g", across);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
}
END_TEST

START_TEST(held_copies_do_not_move) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.033, -9.81);
    const double there = 0.01; /* of which x87 has more digits than a double */
    scene s;
    size_t i;
    int frame;
    seed(2);
    s = scene_block(6, 2, 2, 0.25, 0, 0);
    scene_hold_left(&s);
    for (i = 0; i < 3 * s.model.copy_count; i++) {
        s.velocity[i] = uniform();
        s.displacement[i] = s.held[i / 3] ? there : 0;
        s.forces[i] = uniform();
    }
    step.forces = s.forces;
    for (frame = 0; frame < 20; frame++) {
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        for (i = 0; i < 3 * s.model.copy_count; i++)
            if (s.held[i / 3]) ck_assert(s.displacement[i] == there && s.velocity[i] == 0);
    }
    ck_assert(s.displacement[3 * s.model.copy_count - 1] < -there); /* the free end hangs */
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A hanging body comes to rest in balance, and stays there bit for bit or nearly so. */
START_TEST(hanging_body_finds_its_balance) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(10, -9.81);
    gxs_step_report report;
    scene s = scene_block(4, 2, 2, 0.25, 0, 0);
    double before;
    int frame;
    scene_hold_left(&s);
    step.newton_iterations = 30;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-4;
    for (frame = 0; frame < 8; frame++) {
        before = s.displacement[3 * s.model.copy_count - 1];
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        assert_that(report.residual <= 1e-10, "residual %g after %u", report.residual,
                    (unsigned)report.newton_iterations);
    }
    ck_assert(fabs(before - s.displacement[3 * s.model.copy_count - 1]) < 1e-8);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Same input, same bits; also from a workspace that has held a larger model */
START_TEST(steps_are_repeatable) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.033, -9.81);
    double *first;
    scene s, large = scene_block(5, 5, 5, 0.1, 0, 0);
    size_t i, count;
    int run;
    seed(8);
    s = scene_block(3, 2, 2, 0.25, 0.1, 0);
    count = 3 * s.model.copy_count;
    first = (double *)zeroed(count, sizeof *first);
    for (run = 0; run < 2; run++) {
        seed(9);
        for (i = 0; i < count; i++) s.displacement[i] = 0.1 * uniform(), s.velocity[i] = uniform();
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        if (run == 0) {
            memcpy(first, s.displacement, count * sizeof *first);
            ck_assert_int_eq(advance(solver, &large.model, &step, large.displacement, large.velocity, NULL, NULL),
                             GX_OK);
        }
    }
    ck_assert_int_eq(memcmp(first, s.displacement, count * sizeof *first), 0);
    free(first);
    gxs_solver_destroy(solver);
    scene_free(&s);
    scene_free(&large);
}
END_TEST

/* ---- integrators ---- */

/* A soft bar, bent a little and released, after 0.32 s in steps of dt; end: displacement and velocity of its last
   copy */
static void swing(gxs_integrator integrator, double dt, double damping, double *end) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(dt, 0);
    double *previous[2], *now[2];
    scene s = scene_block(4, 1, 1, 0.5, 0, 0);
    size_t count = 3 * s.model.copy_count, i;
    int frame, frames = (int)(0.32 / dt + 0.5);
    s.material->young = 2e4;
    scene_hold_left(&s);
    for (i = 0; i < 2; i++)
        previous[i] = (double *)zeroed(count, sizeof(double)), now[i] = (double *)zeroed(count, sizeof(double));
    for (i = 0; i < s.model.copy_count; i++) s.displacement[3 * i + 2] = 0.03 * s.rest[3 * i] * s.rest[3 * i];
    step.integrator = integrator;
    step.mass_damping = damping;
    step.newton_iterations = 10;
    step.newton_tolerance = 1e-12;
    step.cg_tolerance = 1e-5;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < frames; frame++) {
        memcpy(now[0], s.displacement, count * sizeof(double));
        memcpy(now[1], s.velocity, count * sizeof(double));
        if (frame > 0) {
            step.previous_displacement = previous[0];
            step.previous_velocity = previous[1];
            step.previous_dt = dt;
        }
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        memcpy(previous[0], now[0], count * sizeof(double));
        memcpy(previous[1], now[1], count * sizeof(double));
    }
    end[0] = s.displacement[count - 1];
    end[1] = s.velocity[count - 1];
    for (i = 0; i < 2; i++) free(previous[i]), free(now[i]);
    gxs_solver_destroy(solver);
    scene_free(&s);
}

/* Halving the step halves backward Euler's error and quarters that of the other two. */
START_TEST(integrators_have_their_order) {
    double truth[2], error[2];
    int k;
    gxs_integrator integrator = (gxs_integrator)(_i / 2);
    double damping = _i % 2 ? 3 : 0;
    swing(GXS_MIDPOINT, 0.32 / 1024, damping, truth);
    for (k = 0; k < 2; k++) {
        double end[2];
        swing(integrator, 0.01 / (1 << k), damping, end);
        error[k] = fabs(end[0] - truth[0]) + 0.05 * fabs(end[1] - truth[1]);
    }
    assert_that(error[0] / error[1] > (integrator == GXS_BDF1 ? 1.6 : 3.2) &&
                    error[0] / error[1] < (integrator == GXS_BDF1 ? 2.5 : 5.5),
                "errors %g %g", error[0], error[1]);
}
END_TEST

/* A bar carried by its held end: the end moves by the targets, with their velocity, and takes the rest along. */
START_TEST(targets_move_held_copies) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.01, 0);
    gxs_step_report report;
    scene s = scene_block(4, 2, 2, 0.25, 0, 0);
    double *targets = (double *)zeroed(3 * s.model.copy_count, sizeof(double));
    size_t i;
    int frame;
    scene_hold_left(&s);
    step.targets = targets;
    step.integrator = _i ? GXS_MIDPOINT : GXS_BDF1;
    step.mass_damping = _i ? 20 : 0;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 1; frame <= 300; frame++) {
        for (i = 0; i < s.model.copy_count; i++) /* others are not read */
            targets[3 * i + 1] = s.held[i] ? (frame < 100 ? 0.01 * frame : 1) : not_a_number(0);
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        for (i = 0; i < s.model.copy_count; i++)
            if (s.held[i]) {
                ck_assert(fabs(s.displacement[3 * i + 1] - targets[3 * i + 1]) < 1e-15);
                assert_that(fabs(s.velocity[3 * i + 1] - (frame <= 100 ? 1 : 0)) < 1e-12, "%g", s.velocity[3 * i + 1]);
            }
    }
    for (i = 0; i < s.model.copy_count; i++)
        assert_that(fabs(s.displacement[3 * i + 1] - 1) < 0.05, "left behind at %g", s.displacement[3 * i + 1]);
    for (i = 0; i < s.model.copy_count; i++) targets[3 * i] = s.held[i] ? not_a_number(1) : 0;
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_ERROR_NOT_FINITE);
    free(targets);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- violent starts ---- */

enum { INVERTED, FLATTENED, COLLAPSED, STRETCHED, TANGLED, START_COUNT };

static void violate(scene *s, int how, double edge) {
    size_t i;
    for (i = 0; i < 3 * s->model.copy_count; i++) switch (how) {
        case INVERTED: s->displacement[i] = i % 3 == 2 ? -2 * s->rest[i] : 0; break;
        case FLATTENED: s->displacement[i] = i % 3 == 2 ? -s->rest[i] : 0; break;
        case COLLAPSED: s->displacement[i] = -s->rest[i]; break;
        case STRETCHED: s->displacement[i] = 2 * s->rest[i]; break;
        default: s->displacement[i] = edge * uniform();
        }
}

/* k Newton iterations from one start, k = 1, 2, ...: the results are the accepted iterates of the longest run */
START_TEST(energy_falls_from_violent_starts) {
    static const double steps[2] = {0.033, 1}, ratios[2] = {0.4, 0.4999};
    gxs_solver *solver = solver_make();
    double *u, *v;
    int how = _i / 4, held;
    uint32_t k;
    size_t count, i;
    double dt = steps[_i % 2];
    for (held = 0; held < 2; held++) {
        gxs_step_desc step = step_make(dt, 0);
        gxs_step_report report;
        double energy;
        scene s;
        seed((uint64_t)_i);
        s = scene_block(3, 2, 2, 0.5, 0.1, 0);
        s.material->poisson = ratios[_i / 2 % 2];
        violate(&s, how, 0.5);
        for (i = 0; held && i < s.model.copy_count; i++) s.held[i] = i % 12 == 0;
        count = 3 * s.model.copy_count;
        u = (double *)zeroed(count, sizeof *u), v = (double *)zeroed(count, sizeof *v);
        energy = form_energy(&s.model, s.displacement);
        for (k = 1; k <= 25; k++) {
            memcpy(u, s.displacement, count * sizeof *u);
            memset(v, 0, count * sizeof *v);
            step.newton_iterations = k;
            ck_assert_int_eq(advance(solver, &s.model, &step, u, v, &report, NULL), GX_OK);
            for (i = 0; i < count; i++) assert_that(finite_bits(u[i]) && finite_bits(v[i]), "not finite");
            assert_that(finite_bits(report.residual) && report.energy <= energy + 1e-12 * fabs(energy),
                        "iterate %u: %.17g after %.17g", (unsigned)k, report.energy, energy);
            energy = report.energy;
            if (report.newton_iterations < k) break;
        }
        free(u), free(v);
        scene_free(&s);
    }
    gxs_solver_destroy(solver);
}
END_TEST

/* A hundred frames from a violent start, the exact collapse (a stationary point) among them, end at rest; so they do
   when disturbed. */
START_TEST(tangled_body_recovers) {
    gxs_solver *solver = solver_make();
    int how, frame;
    for (how = 0; how < 2 * START_COUNT; how++) {
        gxs_step_desc step = step_make(0.033, 0);
        gxs_step_report report;
        double energy, worst;
        size_t i;
        scene s;
        seed((uint64_t)(40 + how));
        s = scene_block(3, 2, 2, 0.5, 0.1, 0);
        violate(&s, how / 2, 0.5);
        for (i = 0; how % 2 && i < 3 * s.model.copy_count; i++) s.displacement[i] += 1e-3 * uniform();
        worst = 0;
        for (frame = 0; frame < 100; frame++) {
            ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
            energy = form_energy(&s.model, s.displacement);
            worst = energy > worst ? energy : worst;
        }
        assert_that(energy < 1, "start %d: %g J of %g J left", how, energy, worst);
        scene_free(&s);
    }
    gxs_solver_destroy(solver);
}
END_TEST

/* Elements of energies that open a collapsed element by themselves, beside others: the body leaves the collapse. */
START_TEST(collapsed_bodies_of_several_materials_open) {
    static const int kinds[3] = {GXS_STABLE_NEO_HOOKEAN, GXS_LINEAR, GXS_CUSTOM};
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.033, 0);
    gxs_step_report report;
    gxs_material materials[3];
    double before, after;
    size_t i;
    scene s;
    seed(7);
    s = scene_block(3, 2, 2, 0.5, 0.1, 0);
    for (i = 0; i < 3; i++) {
        materials[i] = *s.material;
        set_kind(&materials[i], kinds[i]);
    }
    s.model.materials = materials;
    s.model.material_count = 3;
    for (i = 0; i < s.model.element_count; i++) s.elements[i].material = (uint32_t)(i / 16 % 3);
    violate(&s, COLLAPSED, 0.5);
    before = form_energy(&s.model, s.displacement);
    step.newton_iterations = 20;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    after = form_energy(&s.model, s.displacement);
    ck_assert_uint_gt(report.newton_iterations, 0);
    assert_that(after < 0.5 * before, "%g J of %g J", after, before);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- tiny components ---- */

/* CG iterations of one step of a hanging body; a share of the elements has weight and mass scaled by tiny */
static uint32_t iterations_with(double tiny, double *residual) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.033, -9.81);
    gxs_step_report report;
    size_t e, k;
    scene s;
    seed(21);
    s = scene_block(8, 4, 4, 0.25, 0.05, 0);
    for (e = 0; e < s.model.copy_count; e++) s.held[e] = s.rest[3 * e] < 0.125;
    for (e = 0; e < s.model.element_count; e++)
        if (s.rest[3 * s.elements[e].copy[0]] > 1.3) { /* a whole end of the bar, so that whole copies are tiny */
            s.elements[e].weight *= tiny;
            for (k = 0; k < 10; k++) s.elements[e].mass[k] *= tiny;
        }
    step.newton_iterations = 3;
    step.cg_tolerance = 1e-4;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    *residual = report.residual;
    gxs_solver_destroy(solver);
    scene_free(&s);
    return report.cg_iterations;
}

START_TEST(tiny_weights_keep_iterations_bounded) {
    double residual, tiny;
    uint32_t plain = iterations_with(1, &residual), count;
    /* From about 1e-40 on, beyond single precision */
    for (tiny = 1e-3; tiny > 1e-300; tiny *= tiny > 1e-20 ? 1e-3 : 1e-9) {
        count = iterations_with(tiny, &residual);
        assert_that(count <= 3 * plain && residual < 1e-2, "%g: %u iterations, %u without, residual %g", tiny,
                    (unsigned)count, (unsigned)plain, residual);
    }
}
END_TEST

/* Parts of tetrahedra around a point. Motions of the corners that leave the point in place move hardly any mass.
   Single precision must not make that mass negative, nor change its size. [rho int N_i N_j of a tetrahedron with
   corners b_a in barycentric coordinates] */
START_TEST(masses_of_slivers_are_semidefinite) {
    gxs_solver *solver = solver_make();
    gxs_material material = material_make(GXS_STABLE_NEO_HOOKEAN, 0.3);
    gxs_element element;
    gxs_model model;
    double rest[12] = {0}, still[12] = {0}, size;
    seed(31);
    material.young = 1e-20;
    memset(&model, 0, sizeof model);
    model.copy_count = 4, model.elements = &element, model.element_count = 1, model.materials = &material,
    model.material_count = 1;
    rest[3] = rest[7] = rest[11] = 1;
    model.positions = rest;
    for (size = 1; size > 1e-7; size *= 0.1) {
        int round;
        for (round = 0; round < 50; round++) {
            const uint32_t order[4] = {(uint32_t)round % 4, (uint32_t)(round + 1) % 4, (uint32_t)(round + 2) % 4,
                                       (uint32_t)(round + 3) % 4};
            double at[4], off[4][4], d[12] = {0}, y[12], all = 0, sum, centre = 0, expected = 0, got = 0, most = 0;
            int i, j, a;
            memset(&element, 0, sizeof element);
            for (i = 0; i < 4; i++) all += at[i] = pow(0.5 + 0.5 * uniform(), round % 7 + 1);
            for (i = 0; i < 4; i++) {
                at[i] /= all;
                element.copy[i] = order[i];
                for (a = 0, sum = 0; a < 4; a++)
                    sum += off[a][i] = i < 3 ? size * uniform() : -off[a][0] - off[a][1] - off[a][2];
                for (a = 0; a < 4; a++) off[a][i] -= 0.25 * sum;
            }
            element.weight = 1;
            for (i = 1; i < 4; i++) element.gradient[i][i - 1] = 1;
            for (i = 0, j = 0; i < 4; i++)
                for (a = i; a < 4; a++, j++)
                    element.mass[j] = at[i] * at[a] + (off[0][i] * off[0][a] + off[1][i] * off[1][a] +
                                                       off[2][i] * off[2][a] + off[3][i] * off[3][a]) /
                                                          20;
            for (i = 0; i < 4; i++) centre += at[i] * (d[3 * order[i]] = uniform());
            for (i = 0; i < 4; i++) {
                d[3 * i] -= centre;
                most = fabs(d[3 * i]) > most ? fabs(d[3 * i]) : most;
            }
            for (a = 0; a < 4; a++) {
                double moved = 0;
                for (i = 0; i < 4; i++) moved += off[a][i] * d[3 * order[i]];
                expected += moved * moved / 20;
            }
            ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
            ck_assert_int_eq(gxs_solver_linearise(solver, still, 1, 0, NULL), GX_OK);
            ck_assert_int_eq(gxs_solver_product(solver, d, y, NULL), GX_OK);
            for (i = 0; i < 12; i++) got += d[i] * y[i];
            assert_that(fabs(got - expected) < 1e-4 * expected + 1e-13 * most * most, "of size %g: %g, not %g", size,
                        got, expected);
        }
    }
    gxs_solver_destroy(solver);
}
END_TEST

/* Masses next to singular, with entries that are only rounding, of any size: the product is that of the given
   masses. */
START_TEST(masses_next_to_singular) {
    static const double scales[4] = {1, 1e-200, 1e-280, 1e150};
    gxs_solver *solver = solver_make();
    gxs_material material = material_make(GXS_STABLE_NEO_HOOKEAN, 0.3);
    gxs_element element;
    gxs_model model;
    gxs_step_desc step = step_make(0.01, -9.81);
    double rest[12] = {0};
    gx_result result;
    int round, i, j, at, k;
    seed(32);
    memset(&model, 0, sizeof model);
    model.copy_count = 4, model.elements = &element, model.element_count = 1, model.materials = &material,
    model.material_count = 1;
    rest[3] = rest[7] = rest[11] = 1;
    model.positions = rest;
    for (round = 0; round < 400; round++) {
        const int away = round % 4; /* the corner of next to no mass */
        double factor[4][2], still[12] = {0}, moved[12] = {0}, speed[12] = {0}, d[12], y[12], expected[12], most = 0;
        memset(&element, 0, sizeof element);
        for (i = 0; i < 4; i++) {
            element.copy[i] = (uint32_t)i;
            for (k = 0; k < 3 && i > 0; k++) element.gradient[i][k] = i - 1 == k;
            factor[i][0] = i == away ? 0 : 0.5 + 0.4 * uniform(), factor[i][1] = i == away ? 0 : 0.3 * uniform();
        }
        for (i = 0, at = 0; i < 4; i++)
            for (j = i; j < 4; j++, at++) {
                element.mass[at] = factor[i][0] * factor[j][0] + factor[i][1] * factor[j][1];
                if (i == away || j == away) element.mass[at] = i == j ? pow(10, -30 - round % 11) : 1e-17 * uniform();
            }
        for (i = 0; i < 12; i++) d[i] = uniform();
        if (round % 3 == 0) { /* a step of any such mass falls */
            for (i = 0; i < 10; i++) element.mass[i] *= scales[round / 3 % 4];
            element.weight = 1;
            material.young = 1e3 * scales[round / 3 % 4];
            ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
            result = gxs_solver_step(solver, &step, moved, speed, NULL, NULL);
            assert_that(result == GX_OK, "times %g: result %d", scales[round / 3 % 4], (int)result);
            for (i = 0; i < 12; i++)
                assert_that(fabs(speed[i] - (i % 3 == 2 ? -0.0981 : 0)) < 1e-6, "times %g: %g", scales[round / 3 % 4],
                            speed[i]);
            continue;
        }
        material.young = 1e-20, element.weight = 1;
        ck_assert_int_eq(gxs_solver_set_model(solver, &model, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_linearise(solver, still, 1, 0, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_product(solver, d, y, NULL), GX_OK);
        form_mass_product(&model, d, expected);
        for (i = 0; i < 12; i++) most = fabs(expected[i]) > most ? fabs(expected[i]) : most;
        for (i = 0; i < 12; i++) assert_that(fabs(y[i] - expected[i]) < 2e-6 * most, "%g, not %g", y[i], expected[i]);
    }
    gxs_solver_destroy(solver);
}
END_TEST

/* Elements without weight, but with a mass of which a corner has hardly any or none: the same copies move whether
   the model is set or changed. */
START_TEST(supports_are_the_same_after_updates) {
    scene s;
    gxs_solver *solver = solver_make();
    gxs_change change;
    gxs_step_desc step = step_make(0.01, -9.81);
    gxs_step_report report[2];
    uint32_t *origins, *groups;
    size_t i, n, base, count;
    double tiny = _i == 0 ? 0 : pow(10, -4 * _i);
    seed(33);
    s = scene_block(2, 2, 2, 0.25, 0.1, 4);
    base = s.model.copy_count, count = s.model.element_count;
    s.model.copy_count += 4, s.model.element_count += 1;
    n = s.model.copy_count;
    s.elements[count] = s.elements[0];
    for (i = 0; i < 4; i++) {
        memcpy(s.rest + 3 * (base + i), s.rest + 3 * s.elements[0].copy[i], 3 * sizeof(double));
        s.elements[count].copy[i] = (uint32_t)(base + i);
    }
    s.elements[count].weight = 0;
    for (i = 0; i < 10; i++) s.elements[count].mass[i] = 0;
    s.elements[count].mass[0] = s.elements[count].mass[7] = s.elements[count].mass[9] = 1,
    s.elements[count].mass[4] = tiny;
    origins = (uint32_t *)zeroed(n, sizeof *origins), groups = (uint32_t *)zeroed(count + 1, sizeof *groups);
    for (i = 0; i < n; i++) origins[i] = 2 * (uint32_t)i;
    for (i = 0; i <= count; i++) s.elements[i].group = groups[i] = (uint32_t)i;
    memset(&change, 0, sizeof change);
    change.copy_count = n, change.origins = origins;
    change.groups = groups + count, change.group_count = change.element_count = 1, change.elements = s.elements + count;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report[0], NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_update(solver, &change, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report[1], NULL), GX_OK);
    ck_assert_uint_eq(report[0].active_unknowns, report[1].active_unknowns);
    ck_assert_uint_eq(report[0].active_unknowns, 3 * n - (tiny > 3e-8 ? 0 : 3));
    gxs_solver_destroy(solver);
    free(origins), free(groups);
    scene_free(&s);
}
END_TEST

/* A tiny loose element stretched to twice its size, beside a large body at rest, must be seen and must come back. */
START_TEST(tiny_pieces_are_seen) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(1, 0);
    gxs_step_report report;
    double energy;
    size_t i, base, last;
    scene s;
    seed(4);
    s = scene_block(4, 4, 4, 0.25, 0, 4);
    base = s.model.copy_count;
    last = s.model.element_count++;
    s.elements[last] = s.elements[0];
    s.elements[last].weight *= 1e-12;
    for (i = 0; i < 10; i++) s.elements[last].mass[i] *= 1e-12;
    for (i = 0; i < 12; i++) s.displacement[3 * base + i] = s.rest[3 * s.elements[last].copy[i / 3] + i % 3];
    for (i = 0; i < 4; i++) s.elements[last].copy[i] = (uint32_t)(base + i);
    s.model.copy_count += 4;
    step.newton_iterations = 50;
    step.newton_tolerance = 1e-8;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    energy = form_energy(&s.model, s.displacement);
    assert_that(energy < 1e-6 * s.elements[last].weight * s.material->young, "energy %g", energy);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* Elements that keep everything but their material. Their earlier energies are not the present ones, and still no
   step ends above its start. */
START_TEST(another_material_does_not_lift_energy) {
    static const double speeds[5] = {20, 100, 500, 5, 2000};
    scene s;
    gxs_material materials[2];
    gxs_solver *solver = NULL;
    gxs_step_desc step;
    gxs_change change;
    uint32_t *origins, *groups;
    double *un, *vn, stays;
    size_t i, n;
    ck_assert_int_eq(gxs_solver_create(NULL, &solver, NULL), GX_OK);
    seed((uint64_t)_i);
    s = scene_block(2, 2, 2, 0.25, 0.1, 0);
    n = s.model.copy_count;
    for (i = 0; i < n; i++) s.held[i] = s.rest[3 * i] < 0.1 || s.rest[3 * i] > 0.4;
    materials[0] = materials[1] = *s.material;
    materials[0].young = 1e9;
    materials[1].young = 1e5;
    materials[1].kind = (gxs_material_kind)(_i % 4);
    s.model.materials = materials;
    s.model.material_count = 2;
    origins = (uint32_t *)malloc(n * sizeof *origins);
    groups = (uint32_t *)malloc(s.model.element_count * sizeof *groups);
    un = (double *)malloc(3 * n * sizeof *un);
    vn = (double *)malloc(3 * n * sizeof *vn);
    for (i = 0; i < n; i++) origins[i] = 2 * (uint32_t)i;
    for (i = 0; i < s.model.element_count; i++) s.elements[i].group = groups[i] = (uint32_t)i;
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (i = 0; i < 3 * n; i++) s.displacement[i] = i % 3 == 0 ? s.rest[i] : 0;
    memset(&step, 0, sizeof step);
    step.dt = 0.03;
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    for (i = 0; i < s.model.element_count; i++) s.elements[i].material = 1;
    memset(&change, 0, sizeof change);
    change.copy_count = n, change.origins = origins, change.held = s.held;
    change.groups = groups, change.group_count = change.element_count = s.model.element_count,
    change.elements = s.elements;
    ck_assert_int_eq(gxs_solver_update(solver, &change, NULL), GX_OK);
    for (i = 0; i < 3 * n; i++) s.velocity[i] = s.held[i / 3] ? 0 : speeds[_i % 5] * uniform();
    memcpy(un, s.displacement, 3 * n * sizeof *un);
    memcpy(vn, s.velocity, 3 * n * sizeof *vn);
    stays = incremental_potential(&s, &step, un, vn, un);
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    ck_assert(incremental_potential(&s, &step, un, vn, s.displacement) <= stays * (1 + 1e-12));
    free(origins), free(groups), free(un), free(vn);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- gradients ---- */

/* Elements whose gradients the solver computes itself */
static size_t own_gradients(const gxs_solver *solver) {
    const gxsp_system *system = solver->system;
    size_t count = 0;
    uint32_t c, b;
    size_t lane;
    for (c = 0; c < system->mesh.chunk_count; c++)
        for (b = 0; b < system->mesh.chunks[c].block_count && system->mesh.chunks[c].gradients; b++)
            for (lane = 0; lane < sizeof(gxsp_lanes) / sizeof(double); lane++)
                count += system->mesh.chunks[c].rest[b].weight[lane] > 0;
    return count;
}

static void scale_gradient(gxs_element *element, double factor) {
    int k;
    for (k = 0; k < 12; k++) element->gradient[k / 3][k % 3] *= factor;
}

/* Steps of a, and of b, which has no positions, end alike. */
static void advance_both(gxs_solver **solvers, scene *s, gxs_step_desc *step, double *displacement, double *velocity) {
    const size_t n = 3 * s->model.copy_count;
    size_t i;
    int k;
    for (k = 0; k < 3; k++) {
        ck_assert_int_eq(gxs_solver_step(solvers[0], step, s->displacement, s->velocity, NULL, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_step(solvers[1], step, displacement, velocity, NULL, NULL), GX_OK);
    }
    for (i = 0; i < n; i++)
        assert_that(fabs(s->displacement[i] - displacement[i]) < 1e-9 * largest(displacement, n), "%g %g",
                    s->displacement[i], displacement[i]);
}

/* Elements need not fit their places. Some have gradients of their own before an update, and others after it. A
   solver without positions, and so with all gradients given, takes the same steps. */
START_TEST(gradients_need_not_be_those_of_positions) {
    gxs_solver *solvers[2];
    gxs_solver_desc desc;
    gxs_step_desc step = step_make(0.02, -9.81);
    gxs_change change;
    uint32_t *origins, groups[200];
    double *displacement, *velocity;
    size_t i, n, own = 0;
    scene s;
    memset(&desc, 0, sizeof desc);
    memset(&change, 0, sizeof change);
    desc.preconditioner = GXS_BLOCK_JACOBI;
    seed((uint64_t)_i);
    s = scene_block(6, 4, 4, 0.25, 0.1, 0);
    set_kind(s.material, _i);
    n = 3 * s.model.copy_count;
    displacement = (double *)zeroed(n, sizeof *displacement), velocity = (double *)zeroed(n, sizeof *velocity);
    origins = (uint32_t *)zeroed(n / 3, sizeof *origins);
    for (i = 0; i < n / 3; i++) {
        s.held[i] = s.rest[3 * i] < 0.1;
        origins[i] = 2 * (uint32_t)i;
    }
    for (i = 0; i < s.model.element_count; i++) {
        s.elements[i].group = (uint32_t)i;
        if (i % 5 == 0) scale_gradient(&s.elements[i], 1.04), ++own;
        if (i % 3 == 0) s.elements[i].mass[0] *= 1.01; /* not that of a whole element */
    }
    step.newton_iterations = 30;
    step.newton_tolerance = 1e-12;
    step.cg_tolerance = 1e-4;
    for (i = 0; i < 2; i++) {
        s.model.positions = i == 0 ? s.rest : NULL;
        ck_assert_int_eq(gxs_solver_create(&desc, &solvers[i], NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_set_model(solvers[i], &s.model, NULL), GX_OK);
    }
    ck_assert_uint_eq(own_gradients(solvers[0]), own);
    ck_assert_uint_eq(own_gradients(solvers[1]), s.model.element_count);
    advance_both(solvers, &s, &step, displacement, velocity);
    for (i = 0; i < 200; i++) {
        const uint32_t of = groups[i] = (uint32_t)i;
        if (i % 2 == 0) scale_gradient(&s.elements[of], of % 5 == 0 ? 1 / 1.04 : 1.05);
        own += i % 2 != 0 ? 0 : of % 5 == 0 ? (size_t)-1 : 1;
    }
    change.copy_count = n / 3, change.origins = origins, change.held = s.held, change.groups = groups;
    change.group_count = change.element_count = 200, change.elements = s.elements;
    for (i = 0; i < 2; i++) ck_assert_int_eq(gxs_solver_update(solvers[i], &change, NULL), GX_OK);
    ck_assert_uint_eq(own_gradients(solvers[0]), own);
    advance_both(solvers, &s, &step, displacement, velocity);
    gxs_solver_destroy(solvers[0]), gxs_solver_destroy(solvers[1]);
    free(origins), free(displacement), free(velocity);
    scene_free(&s);
}
END_TEST

/* the report's energy is E of the manual */
START_TEST(reported_energy_is_the_incremental_potential) {
    gxs_solver *solver = solver_make();
    gxs_step_desc step = step_make(0.033, -9.81);
    gxs_step_report report;
    double *un, *vn, energy;
    size_t i, count;
    scene s;
    seed(14);
    s = scene_block(3, 2, 2, 0.25, 0.1, 0);
    count = 3 * s.model.copy_count;
    un = (double *)zeroed(count, sizeof *un), vn = (double *)zeroed(count, sizeof *vn);
    for (i = 0; i < count; i++)
        un[i] = s.displacement[i] = 0.1 * uniform(), vn[i] = s.velocity[i] = uniform(), s.forces[i] = 10 * uniform();
    step.forces = s.forces;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    energy = incremental_potential(&s, &step, un, vn, s.displacement);
    assert_that(fabs(report.energy - energy) < 1e-9 * (1 + fabs(energy)), "%.17g %.17g", report.energy, energy);
    free(un), free(vn);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* ---- bad input ---- */

typedef struct attempt {
    scene s;
    gxs_step_desc step;
    gx_failure failure;
    gxs_solver *solver;
} attempt;

static attempt attempt_make(void) {
    attempt a;
    a.s = scene_block(2, 1, 1, 0.5, 0, 0);
    a.step = step_make(0.033, -9.81);
    a.solver = solver_make();
    return a;
}

/* The step must fail with this code, at that index, and leave the state alone. */
static void expect(attempt *a, gx_result result, const char *field, size_t index) {
    size_t bytes = 3 * sizeof(double) * (a->s.model.copy_count ? a->s.model.copy_count : 1);
    double *before = (double *)zeroed(2, bytes);
    memcpy(before, a->s.displacement, bytes);
    memcpy((char *)before + bytes, a->s.velocity, bytes);
    ck_assert_int_eq(advance(a->solver, &a->s.model, &a->step, a->s.displacement, a->s.velocity, NULL, &a->failure),
                     result);
    ck_assert_int_eq(a->failure.result, result);
    ck_assert_pstr_eq(a->failure.field, field);
    ck_assert_uint_eq(a->failure.index, index);
    ck_assert_int_eq(memcmp(before, a->s.displacement, bytes), 0);
    ck_assert_int_eq(memcmp((char *)before + bytes, a->s.velocity, bytes), 0);
    free(before);
    gxs_solver_destroy(a->solver);
    scene_free(&a->s);
}

#define attempt_with(change, result, field, index)                                                                     \
    do {                                                                                                               \
        attempt a = attempt_make();                                                                                    \
        change;                                                                                                        \
        expect(&a, result, field, index);                                                                              \
    } while (0)

START_TEST(bad_input_is_named) {
    double nan = not_a_number(0), infinity = not_a_number(1);
    attempt_with(a.step.dt = 0, GX_ERROR_ARGUMENT, "dt", SIZE_MAX);
    attempt_with(a.step.dt = -1, GX_ERROR_ARGUMENT, "dt", SIZE_MAX);
    attempt_with(a.step.dt = nan, GX_ERROR_NOT_FINITE, "dt", SIZE_MAX);
    attempt_with(a.step.cg_tolerance = -1, GX_ERROR_ARGUMENT, "cg_tolerance", SIZE_MAX);
    attempt_with(a.step.cg_tolerance = 1, GX_ERROR_ARGUMENT, "cg_tolerance", SIZE_MAX);
    attempt_with(a.step.mass_damping = -1, GX_ERROR_ARGUMENT, "mass_damping", SIZE_MAX);
    attempt_with(a.step.mass_damping = nan, GX_ERROR_NOT_FINITE, "mass_damping", SIZE_MAX);
    attempt_with(a.step.integrator = (gxs_integrator)(GXS_EXPLICIT + 1), GX_ERROR_ARGUMENT, "integrator", SIZE_MAX);
    attempt_with(a.step.integrator = GXS_BDF2; a.step.previous_displacement = a.s.forces;
                 a.step.previous_dt = 1, GX_ERROR_ARGUMENT, "previous_velocity", SIZE_MAX);
    attempt_with(a.step.integrator = GXS_BDF2; a.step.previous_displacement = a.step.previous_velocity = a.s.forces,
                                               GX_ERROR_ARGUMENT, "previous_dt", SIZE_MAX);
    attempt_with(a.step.integrator = GXS_BDF2; a.step.previous_displacement = a.step.previous_velocity = a.s.forces;
                 a.step.previous_dt = 1; a.s.forces[5] = nan, GX_ERROR_NOT_FINITE, "previous_displacement", 1);
    attempt_with(a.step.newton_tolerance = infinity, GX_ERROR_NOT_FINITE, "newton_tolerance", SIZE_MAX);
    attempt_with(a.step.gravity[1] = nan, GX_ERROR_NOT_FINITE, "gravity", SIZE_MAX);
    attempt_with(a.step.forces = a.s.forces; a.s.forces[7] = nan, GX_ERROR_NOT_FINITE, "forces", 2);
    attempt_with(a.s.displacement[10] = infinity, GX_ERROR_NOT_FINITE, "displacement", 3);
    attempt_with(a.s.velocity[0] = nan, GX_ERROR_NOT_FINITE, "velocity", 0);
    attempt_with(a.s.material->young = 0, GX_ERROR_ARGUMENT, "materials.young", 0);
    attempt_with(a.s.material->young = nan, GX_ERROR_NOT_FINITE, "materials.young", 0);
    attempt_with(a.s.material->poisson = 0.5, GX_ERROR_ARGUMENT, "materials.poisson", 0);
    attempt_with(a.s.material->poisson = -0.1, GX_ERROR_ARGUMENT, "materials.poisson", 0);
    attempt_with(a.s.material->kind = (gxs_material_kind)KINDS, GX_ERROR_ARGUMENT, "materials.kind", 0);
    attempt_with(a.s.material->kind = GXS_CUSTOM, GX_ERROR_ARGUMENT, "materials.energy", 0); /* without an energy */
    attempt_with(a.s.material->damping = -1, GX_ERROR_ARGUMENT, "materials.damping", 0);
    attempt_with(a.s.material->damping = not_a_number(1), GX_ERROR_NOT_FINITE, "materials.damping", 0);
    attempt_with(a.s.model.materials = NULL, GX_ERROR_ARGUMENT, "materials", SIZE_MAX);
    attempt_with(a.s.model.material_count = 0, GX_ERROR_EMPTY, "material_count", SIZE_MAX);
    attempt_with(a.s.elements[2].material = 1, GX_ERROR_INDEX, "elements.material", 2);
    attempt_with(a.s.rest[4] = nan, GX_ERROR_NOT_FINITE, "positions", 1);
    attempt_with(a.s.model.copy_count = 0, GX_ERROR_EMPTY, "copy_count", SIZE_MAX);
    attempt_with(a.s.model.element_count = 0, GX_ERROR_EMPTY, "element_count", SIZE_MAX);
    attempt_with(a.s.model.elements = NULL, GX_ERROR_ARGUMENT, "elements", SIZE_MAX);
    attempt_with(a.s.elements[3].copy[2] = (uint32_t)a.s.model.copy_count, GX_ERROR_INDEX, "elements.copy", 3);
    attempt_with(a.s.elements[4].gradient[2][1] = nan, GX_ERROR_NOT_FINITE, "elements.gradient", 4);
    attempt_with(a.s.elements[5].weight = infinity, GX_ERROR_NOT_FINITE, "elements.weight", 5);
    attempt_with(a.s.elements[5].weight = -1, GX_ERROR_INVERTED, "elements.weight", 5);
    attempt_with(a.s.elements[6].mass[9] = nan, GX_ERROR_NOT_FINITE, "elements.mass", 6);
    attempt_with(a.s.elements[6].mass[4] = -1, GX_ERROR_ARGUMENT, "elements.mass", 6);
    ck_assert_int_eq(gxs_solver_create(NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(advance(NULL, NULL, NULL, NULL, NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    gxs_solver_destroy(NULL);
}
END_TEST

/* numbers that are finite and too large to step with */
/* An energy whose Hessians are beyond single precision once `left` of them have been computed */
typedef struct failing_energy {
    const gxs_material *material;
    size_t left;
} failing_energy;

static double fail_later(void *user, const double *f, double *stress, double *hessian_at_f) {
    failing_energy *of = (failing_energy *)user;
    double h[9][9];
    int i, j;
    if (stress) gxs_material_stress(of->material, f, stress);
    if (hessian_at_f) {
        hessian(of->material, f, h);
        for (i = 0; i < 9; i++)
            for (j = 0; j < 9; j++) hessian_at_f[9 * i + j] = of->left > 0 ? h[i][j] : i == j ? 1e200 : 0;
        of->left -= of->left > 0;
    }
    return gxs_material_energy(of->material, f);
}

/* A step that fails after good iterations ends with their result; one that fails at once ends with an error. */
START_TEST(late_failures_keep_what_was_found) {
    gxs_solver *solver = solver_make();
    gxs_material inner_material = material_make(GXS_STABLE_NEO_HOOKEAN, 0.3), custom = inner_material;
    failing_energy energy;
    gxs_step_desc step = step_make(0.05, -9.81);
    gxs_step_report report;
    double *un, *vn, *first, start;
    size_t i, n, lanes;
    scene s;
    seed(5);
    s = scene_block(2, 2, 2, 0.25, 0.05, 0);
    n = 3 * s.model.copy_count, lanes = 8 * ((s.model.element_count + 7) / 8);
    un = (double *)zeroed(n, sizeof *un), vn = (double *)zeroed(n, sizeof *vn),
    first = (double *)zeroed(n, sizeof *first);
    for (i = 0; i < n; i++) {
        s.held[i / 3] = s.rest[3 * (i / 3)] < 0.1;
        un[i] = s.displacement[i] = s.held[i / 3] ? 0 : 0.1 * uniform();
    }
    energy.material = &inner_material;
    custom.kind = GXS_CUSTOM, custom.energy = fail_later, custom.user = &energy;
    s.model.materials = &custom;
    step.newton_iterations = 1;
    energy.left = lanes;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    memcpy(first, s.displacement, n * sizeof *first);
    memcpy(s.displacement, un, n * sizeof *un), memcpy(s.velocity, vn, n * sizeof *vn);
    step.newton_iterations = 10;
    step.newton_tolerance = 1e-12;
    energy.left = lanes;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
    assert_that(report.stop == GXS_STOP_ROUNDING && report.newton_iterations == 1,
                "stop %d after %u iterations, residual %g", (int)report.stop, (unsigned)report.newton_iterations,
                report.residual);
    for (i = 0; i < n; i++)
        assert_that(fabs(s.displacement[i] - first[i]) < 1e-12, "%g %g", s.displacement[i], first[i]);
    s.model.materials = &inner_material;
    start = incremental_potential(&s, &step, un, vn, un);
    ck_assert(incremental_potential(&s, &step, un, vn, s.displacement) < start);
    s.model.materials = &custom;
    memcpy(s.displacement, un, n * sizeof *un), memcpy(s.velocity, vn, n * sizeof *vn);
    energy.left = 0;
    ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_ERROR_DIVERGED);
    ck_assert(memcmp(s.displacement, un, n * sizeof *un) == 0);
    gxs_solver_destroy(solver);
    free(un), free(vn), free(first);
    scene_free(&s);
}
END_TEST

START_TEST(overflow_is_divergence) {
    attempt_with(a.s.displacement[0] = 1e200, GX_ERROR_DIVERGED, NULL, SIZE_MAX);
    attempt_with(a.s.velocity[4] = 1e120, GX_ERROR_DIVERGED, NULL, SIZE_MAX);
    attempt_with(a.step.dt = 1e-200, GX_ERROR_RANGE, "dt", SIZE_MAX);
    attempt_with(a.step.dt = 1e200, GX_ERROR_RANGE, "dt", SIZE_MAX);
    { /* all copies are held, and their targets are further than any speed reaches */
        double targets[36];
        int i;
        for (i = 0; i < 36; i++) targets[i] = 1e250;
        attempt_with(a.step.dt = 1e-70; a.step.targets = targets;
                     memset(a.s.held, 1, 12), GX_ERROR_DIVERGED, NULL, SIZE_MAX);
    }
    attempt_with(a.s.material->young = 1e308; a.s.displacement[0] = 10, GX_ERROR_DIVERGED, NULL, SIZE_MAX);
}
END_TEST

/* copies without an element, elements without weight, bodies without mass, velocities beyond reach */
START_TEST(degenerate_models_are_harmless) {
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    int which;
    memset(&desc, 0, sizeof desc);
    desc.preconditioner = _i ? GXS_MULTIGRID : GXS_AUTOMATIC;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    for (which = 0; which < 8; which++) {
        gxs_step_desc step = step_make(0.033, -9.81);
        gxs_step_report report;
        size_t e, k;
        scene s = scene_block(2, 2, 2, 0.5, 0, 8);
        for (e = 0; e < s.model.element_count; e++) {
            if (which == 1 || (which == 2 && e % 2)) s.elements[e].weight = 0;
            for (k = 0; k < 10; k++)
                if (which >= 2 && which < 4 && (which == 3 || e % 2)) s.elements[e].mass[k] = 0;
            if (which == 5 && e < 24) { /* neither weight nor mass */
                s.elements[e].weight = 0;
                memset(s.elements[e].mass, 0, sizeof s.elements[e].mass);
            }
            if (which == 7 && e % 3 == 0) { /* no weight, and mass at the last corner only */
                s.elements[e].weight = 0;
                memset(s.elements[e].mass, 0, sizeof s.elements[e].mass);
                s.elements[e].mass[9] = 1;
            }
            /* the gradients of no element that has a volume */
            if (which == 6) memset(s.elements[e].gradient, 0, sizeof s.elements[e].gradient);
        }
        if (which == 4)
            for (e = 0; e < 3 * s.model.copy_count; e++) s.velocity[e] = e % 3 ? 1e60 : -1e60;
        s.model.copy_count += 8;
        s.forces[3 * s.model.copy_count - 1] = 1e9; /* on a copy of no element */
        step.forces = s.forces;
        step.newton_iterations = 4;
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        for (e = 0; e < 3 * s.model.copy_count; e++)
            assert_that(finite_bits(s.displacement[e]) && finite_bits(s.velocity[e]), "case %d", which);
        for (e = 3 * (s.model.copy_count - 8); e < 3 * s.model.copy_count; e++)
            ck_assert(s.displacement[e] == 0 && s.velocity[e] == 0);
        scene_free(&s);
    }
    gxs_solver_destroy(solver);
}
END_TEST

/* A copy so far from the others that coarse nodes cannot be placed: the solver does without them. */
START_TEST(positions_beyond_single_precision) {
    static const gxs_preconditioner kinds[2] = {GXS_BLOCK_JACOBI, GXS_MULTIGRID};
    double *end[2];
    int i, far_away;
    for (far_away = 0; far_away < 2; far_away++) {
        size_t n = 0, k;
        for (i = 0; i < 2; i++) {
            scene s = scene_block(4, 4, 4, 0.25, 0, 1);
            gxs_solver_desc desc;
            gxs_step_desc step = step_make(0.033, -9.81);
            gxs_step_report report;
            gxs_solver *solver = NULL;
            memset(&desc, 0, sizeof desc);
            desc.preconditioner = kinds[i];
            scene_hold_left(&s);
            n = 3 * s.model.copy_count;
            s.model.copy_count++;
            s.rest[n] = far_away ? 1e9 : 2;
            step.newton_iterations = 5;
            step.cg_tolerance = 1e-9;
            ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
            ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
            ck_assert_int_eq(report.preconditioner, far_away ? GXS_BLOCK_JACOBI : kinds[i]);
            end[i] = (double *)zeroed(n, sizeof(double));
            memcpy(end[i], s.displacement, n * sizeof(double));
            gxs_solver_destroy(solver);
            scene_free(&s);
        }
        for (k = 0; k < n; k++) assert_that(fabs(end[0][k] - end[1][k]) < 1e-9, "%g %g", end[0][k], end[1][k]);
        free(end[0]), free(end[1]);
    }
}
END_TEST

/* ---- memory ---- */

/* Creates a solver and takes three steps, the model growing in between. Returns whether an allocation failed. */
static int run_with(memory *m, int which) {
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    gxs_step_desc step = step_make(0.033, -9.81);
    int size, failed = 0;
    (void)which;
    memset(&desc, 0, sizeof desc);
    desc.allocator = allocator_of(m);
    desc.preconditioner = GXS_MULTIGRID;
    if (gxs_solver_create(&desc, &solver, NULL) != GX_OK) {
        ck_assert_ptr_null(solver);
        return 1;
    }
    for (size = 1; size <= 3; size++) {
        scene s = scene_block(2 * size, size, size, 0.5, 0, 0);
        size_t i;
        gx_result result = advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL);
        if (result == GX_ERROR_MEMORY) {
            failed = 1;
            for (i = 0; i < 3 * s.model.copy_count; i++) ck_assert(s.displacement[i] == 0 && s.velocity[i] == 0);
            if (!m->from_then_on) /* the solver is still good */
                ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        } else
            ck_assert_int_eq(result, GX_OK);
        scene_free(&s);
    }
    gxs_solver_destroy(solver);
    return failed;
}

START_TEST(every_allocation_may_fail) { sweep_allocations(run_with, 0); }
END_TEST

START_TEST(steps_do_not_allocate) {
    gxs_solver_desc desc;
    memory m = plenty();
    gxs_solver *solver = NULL;
    gxs_step_desc step = step_make(0.033, -9.81);
    scene s = scene_block(8, 8, 8, 0.5, 0, 0);
    size_t calls;
    int frame;
    memset(&desc, 0, sizeof desc);
    desc.allocator = allocator_of(&m);
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    calls = m.calls;
    for (frame = 0; frame < 5; frame++)
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_linearise(solver, s.displacement, 1, 0, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_product(solver, s.displacement, s.forces, NULL), GX_OK);
    ck_assert_uint_eq(m.calls, calls);
    gxs_solver_destroy(solver);
    ck_assert(is_whole(&m));
    desc.allocator.release = NULL;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_ERROR_ARGUMENT);
    memset(&desc.allocator, 0, sizeof desc.allocator);
    desc.allocator.reallocate = (void *(*)(void *, void *, size_t, size_t))1;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_ERROR_ARGUMENT);
    scene_free(&s);
}
END_TEST

/* ---- multigrid ---- */

/* From 7 to 13 nodes along the edge, soft and stiff: iterations do not grow, and stay below block-Jacobi's. */
START_TEST(multigrid_iterations_do_not_grow) {
    static const double youngs[2] = {1e6, 1e9};
    uint32_t counts[2][2];
    int size, which;
    for (which = 0; which < 2; which++)
        for (size = 0; size < 2; size++) {
            gxs_solver_desc desc;
            gxs_solver *solver = NULL;
            gxs_step_desc step = step_make(0.033, -9.81);
            gxs_step_report report;
            size_t i;
            scene s;
            seed(31);
            s = scene_block(size ? 12 : 6, size ? 12 : 6, size ? 12 : 6, size ? 1.0 / 12 : 1.0 / 6, 0.1, 0);
            for (i = 0; i < s.model.copy_count; i++) s.held[i] = s.rest[3 * i] < 0.05;
            s.material->young = youngs[_i];
            step.cg_tolerance = 1e-4;
            memset(&desc, 0, sizeof desc);
            desc.preconditioner = which ? GXS_MULTIGRID : GXS_BLOCK_JACOBI;
            ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
            ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
            counts[which][size] = report.cg_iterations;
            gxs_solver_destroy(solver);
            scene_free(&s);
        }
    assert_that(counts[1][1] <= 2 * counts[1][0] && 3 * counts[1][1] < counts[0][1],
                "multigrid %u then %u, block-Jacobi %u then %u", (unsigned)counts[1][0], (unsigned)counts[1][1],
                (unsigned)counts[0][0], (unsigned)counts[0][1]);
}
END_TEST

/* A block that stretches far as it falls, held at a side (0), and one that spins (1). A solver that has made all
   steps is compared with solvers that begin again with each step, without a guess; new matrices cost ten iterations.
   The old matrices may cost at most a tenth more iterations, and one a step. */
START_TEST(coarse_matrices_do_not_grow_old) {
    gxs_step_desc step = step_make(0.033, _i ? 0 : -9.81);
    uint32_t kept = 0, anew = 0;
    gxs_solver_desc desc;
    gxs_solver *solver = NULL;
    gxs_step_report report;
    int frame;
    size_t i;
    scene s;
    seed(37);
    s = scene_block(10, 10, 4, 0.1, 0.1, 0);
    for (i = 0; i < s.model.copy_count; i++) {
        s.held[i] = !_i && s.rest[3 * i] < 0.05;
        s.velocity[3 * i] = _i ? -12 * (s.rest[3 * i + 1] - 0.5) : 0;
        s.velocity[3 * i + 1] = _i ? 12 * (s.rest[3 * i] - 0.5) : 0;
    }
    s.material->young = _i ? 1e6 : 3e4;
    memset(&desc, 0, sizeof desc);
    desc.preconditioner = GXS_MULTIGRID;
    ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
    ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
    for (frame = 0; frame < 30; frame++) {
        gxs_solver *fresh = NULL;
        double *copy = (double *)zeroed(6 * s.model.copy_count, sizeof *copy);
        memcpy(copy, s.displacement, 3 * s.model.copy_count * sizeof *copy);
        memcpy(copy + 3 * s.model.copy_count, s.velocity, 3 * s.model.copy_count * sizeof *copy);
        ck_assert_int_eq(gxs_solver_create(&desc, &fresh, NULL), GX_OK);
        ck_assert_int_eq(advance(fresh, &s.model, &step, copy, copy + 3 * s.model.copy_count, &report, NULL), GX_OK);
        anew += report.cg_iterations;
        ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        kept += report.cg_iterations;
        gxs_solver_destroy(fresh);
        free(copy);
    }
    assert_that(10 * kept <= 11 * anew + 10 * 30, "%u iterations by old matrices, %u by new ones", (unsigned)kept,
                (unsigned)anew);
    gxs_solver_destroy(solver);
    scene_free(&s);
}
END_TEST

/* A block that hangs among loose tetrahedra, which have most of the copies. The solver's own choice is what the
   block needs. */
START_TEST(largest_piece_chooses_the_preconditioner) {
    static const gxs_preconditioner kinds[3] = {GXS_BLOCK_JACOBI, GXS_MULTIGRID, GXS_AUTOMATIC};
    enum { LOOSE = 400 };
    uint32_t counts[3];
    int which;
    for (which = 0; which < 3; which++) {
        gxs_solver_desc desc;
        gxs_solver *solver = NULL;
        gxs_step_desc step = step_make(0.033, -9.81);
        gxs_step_report report;
        scene s = scene_block(8, 8, 8, 0.125, 0, 4 * LOOSE);
        size_t i, k, copies = s.model.copy_count;
        for (i = 0; i < copies; i++) s.held[i] = s.rest[3 * i] < 0.05;
        for (i = 0; i < LOOSE; i++, copies += 4) {
            gxs_element *element = &s.elements[s.model.element_count++];
            *element = s.elements[i];
            for (k = 0; k < 4; k++) {
                memcpy(&s.rest[3 * (copies + k)], &s.rest[3 * element->copy[k]], 3 * sizeof(double));
                element->copy[k] = (uint32_t)(copies + k);
            }
        }
        s.model.copy_count = copies;
        step.cg_tolerance = 1e-4;
        memset(&desc, 0, sizeof desc);
        desc.preconditioner = kinds[which];
        ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        counts[which] = report.cg_iterations;
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
    assert_that(2 * counts[1] < counts[0] && counts[2] == counts[1], "block-Jacobi %u, multigrid %u, left to itself %u",
                (unsigned)counts[0], (unsigned)counts[1], (unsigned)counts[2]);
}
END_TEST

/* A block with this many cells along an edge, held at one side; soft: three quarters of its elements are 1e4 times
   softer. Tests the solver's choice; counts: CG iterations by block-Jacobi, by multigrid, and by the solver's
   choice. With 4 cells no component is large. */
static gxs_preconditioner choice(int cells, double young, double dt, int soft, uint32_t *counts) {
    static const gxs_preconditioner kinds[3] = {GXS_BLOCK_JACOBI, GXS_MULTIGRID, GXS_AUTOMATIC};
    gxs_step_report report;
    int which;
    for (which = 0; which < 3; which++) {
        gxs_solver_desc desc;
        gxs_solver *solver = NULL;
        gxs_step_desc step = step_make(dt, -9.81);
        gxs_material materials[2];
        scene s = scene_block(cells, cells, cells, 1.0 / cells, 0.1, 0);
        size_t i;
        materials[0] = materials[1] = *s.material;
        materials[0].young = young, materials[1].young = 1e-4 * young;
        s.model.materials = materials;
        s.model.material_count = 2;
        for (i = 0; i < s.model.element_count; i++)
            s.elements[i].material = soft && 4 * i > s.model.element_count; /* three quarters are soft */
        for (i = 0; i < s.model.copy_count; i++) s.held[i] = s.rest[3 * i] < 0.05;
        memset(&desc, 0, sizeof desc);
        desc.preconditioner = kinds[which];
        ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
        ck_assert_int_eq(advance(solver, &s.model, &step, s.displacement, s.velocity, &report, NULL), GX_OK);
        ck_assert(which == 2 || report.preconditioner == kinds[which]);
        counts[which] = report.cg_iterations;
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
    ck_assert_uint_eq(counts[2], counts[report.preconditioner == GXS_MULTIGRID]);
    return report.preconditioner;
}

/* Multigrid where stiffness outweighs inertia, even in a quarter of the body; block-Jacobi where it does not, or
   where the body is small */
START_TEST(inertia_chooses_the_preconditioner) {
    uint32_t counts[3];
    ck_assert_int_eq(choice(12, 1e6, 0.033, 0, counts), GXS_MULTIGRID);
    ck_assert_uint_gt(counts[0], 5 * counts[1]);
    ck_assert_int_eq(choice(12, 1e8, 0.033, 0, counts), GXS_MULTIGRID);
    ck_assert_int_eq(choice(12, 1e6, 0.033, 1, counts), GXS_MULTIGRID);
    ck_assert_int_eq(choice(12, 1e6, 0.002, 0, counts), GXS_BLOCK_JACOBI);
    ck_assert_uint_lt(counts[0], 4 * counts[1]);
    ck_assert_int_eq(choice(12, 1e4, 0.033, 0, counts), GXS_BLOCK_JACOBI);
    ck_assert_int_eq(choice(4, 1e6, 0.033, 0, counts), GXS_BLOCK_JACOBI);
}
END_TEST

/* ---- jobs ---- */

static void backwards(void *user, size_t count, void (*task)(void *, size_t), void *context) {
    (void)user;
    while (count-- > 0) task(context, count);
}

typedef struct worker {
    void (*task)(void *, size_t);
    void *context;
    size_t begin, end, step;
} worker;

static void *work(void *argument) {
    worker *w = (worker *)argument;
    size_t i;
    for (i = w->begin; i < w->end; i += w->step) w->task(w->context, i);
    return NULL;
}

/* As many threads as *user says; each takes the indices of one residue */
static void threads(void *user, size_t count, void (*task)(void *, size_t), void *context) {
    size_t workers = *(const size_t *)user, k;
    worker w[4];
    pthread_t id[4];
    for (k = 0; k < workers; k++) {
        w[k].task = task, w[k].context = context, w[k].begin = k, w[k].end = count, w[k].step = workers;
        ck_assert_int_eq(pthread_create(&id[k], NULL, work, &w[k]), 0);
    }
    for (k = 0; k < workers; k++) ck_assert_int_eq(pthread_join(id[k], NULL), 0);
}

/* Ten frames of a falling, tumbling, stretched body, and a product: the same bits in any order and on any number of
   threads */
START_TEST(jobs_do_not_change_results) {
    double *first = NULL;
    size_t workers, count = 0;
    int run, frame;
    for (run = 0; run < 4; run++) { /* alone, backwards, two threads, four */
        gxs_solver_desc desc;
        gxs_solver *solver = NULL;
        gxs_step_desc step = step_make(0.033, -9.81);
        size_t i;
        scene s;
        seed(12);
        s = scene_block(8, 8, 8, 0.125, 0.2, 0);
        scene_hold_left(&s);
        s.model.lumped_mass = _i == 1;
        set_kind(s.material, _i);
        count = 3 * s.model.copy_count;
        for (i = 0; i < count; i++) s.displacement[i] = 0.3 * s.rest[i] + 0.01 * uniform(), s.velocity[i] = uniform();
        memset(&desc, 0, sizeof desc);
        desc.jobs.parallel_for = run == 0 ? NULL : run == 1 ? backwards : threads;
        desc.jobs.user = &workers;
        workers = run == 3 ? 4 : 2;
        ck_assert_int_eq(gxs_solver_create(&desc, &solver, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_set_model(solver, &s.model, NULL), GX_OK);
        for (frame = 0; frame < 10; frame++)
            ck_assert_int_eq(gxs_solver_step(solver, &step, s.displacement, s.velocity, NULL, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_linearise(solver, s.displacement, 900, 0, NULL), GX_OK);
        ck_assert_int_eq(gxs_solver_product(solver, s.velocity, s.forces, NULL), GX_OK);
        if (!first) {
            first = (double *)zeroed(2 * count, sizeof *first);
            memcpy(first, s.displacement, count * sizeof *first);
            memcpy(first + count, s.forces, count * sizeof *first);
        }
        ck_assert_int_eq(memcmp(first, s.displacement, count * sizeof *first), 0);
        ck_assert_int_eq(memcmp(first + count, s.forces, count * sizeof *first), 0);
        gxs_solver_destroy(solver);
        scene_free(&s);
    }
    free(first);
}
END_TEST

static Suite *solve_suite(void) {
    Suite *suite = suite_create("gxfem_solve");
    TCase *material = tcase_create("material"), *model = tcase_create("model"), *step = tcase_create("step");
    TCase *violent = tcase_create("violent"), *input = tcase_create("input");
    tcase_add_test(material, energy_is_the_formula_of_the_paper);
    tcase_add_loop_test(material, rest_and_rotations_are_free_of_stress, 0, KINDS);
    tcase_add_loop_test(material, small_strain_is_linear_elasticity, 0, KINDS);
    tcase_add_loop_test(material, stress_is_the_derivative_of_energy, 0, KINDS);
    tcase_add_loop_test(material, hessian_is_the_projection_of_the_derivative_of_stress, 0, KINDS);
    tcase_add_loop_test(material, projected_hessian_is_semidefinite, 0, KINDS);
    tcase_add_test(model, model_gradient_and_hessian_match_differences);
    tcase_add_loop_test(model, block_product_equals_assembled_forms, 0, 4 * KINDS);
    tcase_add_loop_test(model, operator_is_the_derivative_of_forces, 0, KINDS);
    tcase_add_loop_test(model, operator_acts_on_what_can_move, 0, 4 * KINDS);
    tcase_add_loop_test(model, operator_is_linear_and_semidefinite, 0, KINDS);
    tcase_add_loop_test(model, chunks_of_many_nodes, 0, 3);
    tcase_add_loop_test(model, small_strains_are_not_denormal, 0, GXS_CUSTOM);
    tcase_add_test(model, operator_lasts_until_the_next_step);
    tcase_add_loop_test(model, multigrid_iterations_do_not_grow, 0, 2);
    tcase_add_loop_test(model, coarse_matrices_do_not_grow_old, 0, 2);
    tcase_add_test(model, largest_piece_chooses_the_preconditioner);
    tcase_add_test(model, inertia_chooses_the_preconditioner);
    tcase_add_test(step, free_fall_is_exact);
    tcase_add_test(step, momentum_of_a_free_body_is_balanced);
    tcase_add_test(step, stretched_bar_has_youngs_modulus);
    tcase_add_test(step, held_copies_do_not_move);
    tcase_add_test(step, hanging_body_finds_its_balance);
    tcase_add_test(step, steps_are_repeatable);
    tcase_add_loop_test(step, another_material_does_not_lift_energy, 0, 20);
    tcase_add_test(step, reported_energy_is_the_incremental_potential);
    tcase_add_test(step, tiny_weights_keep_iterations_bounded);
    tcase_add_test(step, masses_of_slivers_are_semidefinite);
    tcase_add_test(step, masses_next_to_singular);
    tcase_add_loop_test(step, supports_are_the_same_after_updates, 0, 5);
    tcase_add_loop_test(step, gradients_need_not_be_those_of_positions, 0, KINDS);
    tcase_add_test(step, tiny_pieces_are_seen);
    tcase_add_loop_test(step, integrators_have_their_order, 0, 6);
    tcase_add_loop_test(step, targets_move_held_copies, 0, 2);
    ADD_SOME(step, jobs_do_not_change_results, KINDS);
    ADD_SOME(violent, energy_falls_from_violent_starts, 4 * START_COUNT);
    tcase_add_test(violent, tangled_body_recovers);
    tcase_add_test(violent, collapsed_bodies_of_several_materials_open);
    tcase_add_test(input, bad_input_is_named);
    tcase_add_test(input, late_failures_keep_what_was_found);
    tcase_add_test(input, overflow_is_divergence);
    tcase_add_loop_test(input, degenerate_models_are_harmless, 0, 2);
    tcase_add_test(input, positions_beyond_single_precision);
    tcase_add_test(input, every_allocation_may_fail);
    tcase_add_test(input, steps_do_not_allocate);
    tcase_set_timeout(violent, 120);
    tcase_set_timeout(step, 120);
    tcase_set_timeout(material, 120);
    suite_add_tcase(suite, material);
    suite_add_tcase(suite, model);
    suite_add_tcase(suite, step);
    suite_add_tcase(suite, violent);
    suite_add_tcase(suite, input);
    return suite;
}

int main(void) { return run_suite(solve_suite()); }
