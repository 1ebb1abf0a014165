/* conditioning.c - condition numbers of the system matrix of a cut cube: RXFEM's Fig. 14 with RXFEM's basis and
   ours, and a corner tetrahedron.

   usage: conditioning [FILE [--small]]; rows go to stdout and to FILE, a table to stderr. --small: the same; it
   takes seconds.

   As in RXFEM section 7: the cube [-1, 1]^3 of five tetrahedra, free; A = M + dt^2 K at rest, E = 1e6 Pa, nu = 0.3,
   rho = 1000 kg/m3, dt = 1e-3 s.
       case       uncut; slice: plane x = 1 - eps; corner: a plane cuts off a corner, eps: its share of its element
       basis      copies: one displacement per node and side (this library). sign: shifted sign enrichment (RXFEM
                  section 4.3), u = sum N_i u_i + sum psi_i N_i a_i, psi_i = (sgn(x) - sgn(x_i)) / 2, from
                  bench/rxfem.h. Both span the same space: where a node has two copies, the one on its own side is
                  u_i, the other u_i + a_i or u_i - a_i
       scaling    S of S^T A S. none; diagonal: A_kk^-1/2; block: inverse factors of the 3x3 diagonal blocks; volume:
                  RXFEM Eq. 26 and 27, the share of its node's one-ring on which a function is not 0, to the power
                  -1/2, by exact volumes (RXFEM's rules are right to 1e-15 of the element only, and it constrains
                  functions below 1e-9); multigrid, for the copies' basis: the solver's own V-cycle P instead of S
                  S^T. P is applied to each unit vector, in single precision. Translations of whole fragments are
                  solved apart, exactly, and count as 1
       extension  off: no copy follows others (support_below is 1e-300). on: gx_body_desc.support_below is 1/2, so
                  that the corner's four copies move together, as a point. Constraints are those of gx_body_model; in
                  the sign basis, what they leave is spanned by u_i and a_i

   Condition numbers go up to 1e41, so eigenvalues are not computed from A. In the copies' basis A is a graded
   matrix. Its factor L, A = L L^T, has small relative errors. Any other basis and scaling is a factor F = S^T B^T L.
   One-sided Jacobi rotations of F's columns give its singular values with small relative errors too [Demmel and
   Veselic 1992]. With double in place of long double the same four digits come out. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"

#define BENCH "conditioning"
#include "expect.h"
#include "csv.h"
#include "progress.h"
#include "rxfem.h"

#include <math.h>

enum { COPIES = 16, SIZE = 3 * COPIES };

typedef long double real;
typedef real matrix[SIZE][SIZE];

static const double young = 1e6, poisson = 0.3, density = 1000, dt = 1e-3;

static const double corners[24] = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1};
static const uint32_t tetrahedra[20] = {0, 5, 3, 6, 1, 3, 0, 5, 2, 0, 3, 6, 4, 6, 5, 0, 7, 5, 6, 3};

/* The copies of a cut cube that follow no others ("free"), and its matrix */
typedef struct cube {
    gx_body *body;
    gxs_model model;
    size_t count, fragments;   /* count: free ones */
    uint32_t free[COPIES];     /* of a copy of the body: its number among the free ones */
    uint32_t node[COPIES];     /* of a free one */
    uint32_t fragment[COPIES]; /* of a free one */
    real volume[COPIES];       /* of its cells, m3 */
    int sign[COPIES][COPIES];  /* RXFEM's function (row) at a free copy */
    matrix a, factor;
} cube;

static rx_rules *rules; /* RXFEM's, as published */

/* ---- the body */

static void cube_create(cube *c, double support_below) {
    gx_body_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.positions = corners;
    desc.node_count = 8;
    desc.elements = tetrahedra;
    desc.element_count = 5;
    desc.young = young;
    desc.poisson = poisson;
    desc.density = density;
    desc.support_below = support_below;
    expect(gx_body_create(&desc, &c->body, NULL) == GX_OK, "no body");
}

/* Cuts by the plane through three points. */
static void cube_cut(cube *c, const double points[9]) {
    static const uint32_t triangle[3] = {0, 1, 2};
    gx_surface sheet;
    gx_cut_desc cut;
    memset(&sheet, 0, sizeof sheet);
    memset(&cut, 0, sizeof cut);
    sheet.vertices = points;
    sheet.vertex_count = 3;
    sheet.triangles = triangle;
    sheet.triangle_count = 1;
    cut.surfaces = &sheet;
    cut.surface_count = 1;
    expect(gx_body_cut(c->body, &cut, NULL, NULL) == GX_OK, "the cut failed");
}

/* The constraint of a copy; NULL: it is free */
static const gxs_constraint *constraint_of(const cube *c, size_t copy) {
    size_t i;
    for (i = 0; i < c->model.constraint_count; i++)
        if (c->model.constraints[i].copy == copy) return &c->model.constraints[i];
    return NULL;
}

/* Numbers the free copies. */
static void cube_number(cube *c, const gx_view *view) {
    size_t i;
    for (i = 0; i < view->copy_count; i++) {
        if (constraint_of(c, i)) continue;
        c->free[i] = (uint32_t)c->count;
        c->node[c->count++] = view->copy_node[i];
    }
    c->fragments = view->fragment_count;
    for (i = 0; i < 4 * view->cell_count; i++)
        if (!constraint_of(c, view->cell_copies[i]))
            c->fragment[c->free[view->cell_copies[i]]] = view->cell_fragment[i / 4];
}

/* ---- RXFEM's functions */

/* Is the fragment's centre in front of the plane (n, d of n . x = d)? NULL: there is one side only */
static int is_in_front(const gx_view *view, size_t cell, const double plane[4]) {
    const double *y = view->fragment_center + 3 * (size_t)view->cell_fragment[cell];
    return plane && plane[0] * y[0] + plane[1] * y[1] + plane[2] * y[2] > plane[3];
}

/* The cell that is RXFEM's piece: in the same element, on the same side if there are two */
static size_t cell_of(const gx_view *view, const rx_body *b, const rx_piece *piece, const double plane[4], int turned) {
    const int divided = b->patch_first[piece->element] < b->patch_first[piece->element + 1];
    size_t cell;
    for (cell = 0; cell < view->cell_count; cell++)
        if (view->cell_element[cell] == piece->element &&
            (!divided || is_in_front(view, cell, plane) == ((int)(piece->plus & 1) != turned)))
            break;
    expect(cell < view->cell_count, "RXFEM has a piece that is no cell");
    return cell;
}

/* Values of the functions at free copies: first u of each node, then the enrichments */
static void read_functions(cube *c, const gx_view *view, const rx_body *b, const double plane[4], int turned) {
    uint32_t functions[64];
    int psi[64], k;
    size_t i, j;
    for (i = 0; i < b->piece_count; i++) {
        const size_t cell = cell_of(view, b, &b->pieces[i], plane, turned);
        for (k = 0; k < 4; k++) {
            const uint32_t copy = view->cell_copies[4 * cell + (size_t)k];
            const size_t count = rx_piece_functions(b, &b->pieces[i], k, functions, psi);
            if (constraint_of(c, copy)) continue;
            c->sign[view->copy_node[copy]][c->free[copy]] = 1;
            for (j = 0; j < count; j++) c->sign[b->node_count + functions[j]][c->free[copy]] = psi[j];
        }
    }
}

static int free_copies(const cube *c, uint32_t node) {
    size_t i;
    int count = 0;
    for (i = 0; i < c->count; i++) count += c->node[i] == node;
    return count;
}

/* Leaves out functions without use for free copies: those of nodes without a copy, and enrichments of nodes with
   one. */
static void keep_functions(cube *c, const rx_body *b) {
    size_t i, kept = 0;
    for (i = 0; i < b->node_count + b->enrichment_count; i++) {
        const int standard = i < b->node_count;
        if (free_copies(c, standard ? (uint32_t)i : b->enrichments[i - b->node_count].node) < (standard ? 1 : 2))
            continue;
        memmove(c->sign[kept++], c->sign[i], sizeof c->sign[i]);
    }
    expect(kept == c->count, "RXFEM has another number of functions");
}

/* The cube as RXFEM cuts it. The plus side is in front of the triangle of the points; turned: behind it */
static void cube_enrich(cube *c, const gx_view *view, const double *points, const double *plane) {
    static const uint32_t triangle[3] = {0, 1, 2};
    rx_body *b = rx_body_create(rules, corners, 8, tetrahedra, 5);
    double normal[3];
    rx_surface sheet;
    sheet.vertices = points;
    sheet.vertex_count = 3;
    sheet.triangles = triangle;
    sheet.triangle_count = 1;
    expect(!points || rx_body_cut(b, &sheet) == RX_OK, "RXFEM refuses the cut");
    expect(b->node_count + b->enrichment_count <= COPIES, "more functions than there is room for");
    if (points) rx_triangle_normal(points, normal);
    read_functions(c, view, b, plane, points && dense_dot(normal, plane, 3) < 0);
    keep_functions(c, b);
    rx_body_destroy(b);
}

/* ---- the matrix */

/* Block of one pair of corners: M_ij 1 + dt^2 w (lambda g_i g_j^T + mu g_j g_i^T + mu g_i . g_j 1). At rest the
   stable neo-Hookean material has the same. */
static void add_pair(real block[3][3], const gxs_element *e, int i, int j, real g[4][3]) {
    static const int packed[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    real mu = (real)young / (2 * (1 + (real)poisson)), lambda = 2 * mu * poisson / (1 - 2 * (real)poisson);
    real scale = (real)dt * dt * e->weight, dot = g[i][0] * g[j][0] + g[i][1] * g[j][1] + g[i][2] * g[j][2];
    int r, s;
    for (r = 0; r < 3; r++)
        for (s = 0; s < 3; s++)
            block[r][s] = scale * (lambda * g[i][r] * g[j][s] + mu * g[j][r] * g[i][s] + (r == s ? mu * dot : 0)) +
                          (r == s ? (real)e->mass[packed[i][j]] : 0);
}

/* The free copies that a copy follows, itself if it is free; returns their number */
static int masters_of(const cube *c, uint32_t copy, uint32_t master[4], real weight[4]) {
    const gxs_constraint *constraint = constraint_of(c, copy);
    int k, count = 0;
    if (!constraint) {
        master[0] = c->free[copy];
        weight[0] = 1;
        return 1;
    }
    for (k = 0; k < 4; k++)
        if (constraint->weight[k] < 0 || constraint->weight[k] > 0) {
            master[count] = c->free[constraint->master[k]];
            weight[count++] = constraint->weight[k];
        }
    return count;
}

/* A += C^T block C, C: rows of the two copies' masters */
static void add_block(cube *c, uint32_t row, uint32_t column, real block[3][3]) {
    uint32_t rows[4], columns[4];
    real left[4], right[4];
    int i, j, r, s, m = masters_of(c, row, rows, left), n = masters_of(c, column, columns, right);
    for (i = 0; i < m; i++)
        for (j = 0; j < n; j++)
            for (r = 0; r < 3; r++)
                for (s = 0; s < 3; s++)
                    c->a[3 * rows[i] + (uint32_t)r][3 * columns[j] + (uint32_t)s] += left[i] * right[j] * block[r][s];
}

static void add_element(cube *c, const gxs_element *e) {
    real g[4][3], block[3][3];
    int i, j, r;
    for (r = 0; r < 3; r++) {
        for (i = 1; i < 4; i++) g[i][r] = e->gradient[i][r];
        g[0][r] = -(g[1][r] + g[2][r] + g[3][r]);
    }
    for (i = 0; i < 4; i++) {
        if (!constraint_of(c, e->copy[i])) c->volume[c->free[e->copy[i]]] += (real)e->weight;
        for (j = 0; j < 4; j++) {
            add_pair(block, e, i, j, g);
            add_block(c, e->copy[i], e->copy[j], block);
        }
    }
}

/* A = L L^T with pivots by size. Rows of L stay in place, columns come in the order of pivots. Destroys a copy of A. */
static void cube_factor(cube *c) {
    static matrix a;
    int done[SIZE] = {0};
    size_t n = 3 * c->count, k, i, j;
    memcpy(a, c->a, sizeof a);
    memset(c->factor, 0, sizeof c->factor);
    for (k = 0; k < n; k++) {
        size_t pivot = n;
        real root;
        for (i = 0; i < n; i++)
            if (!done[i] && (pivot == n || a[i][i] > a[pivot][pivot])) pivot = i;
        expect(pivot < n && a[pivot][pivot] > 0, "the matrix is not positive definite in long double");
        root = sqrtl(a[pivot][pivot]);
        done[pivot] = 1;
        c->factor[pivot][k] = root;
        for (i = 0; i < n; i++)
            if (!done[i]) c->factor[i][k] = a[i][pivot] / root;
        for (i = 0; i < n; i++)
            for (j = 0; j < n && !done[i]; j++)
                if (!done[j]) a[i][j] -= c->factor[i][k] * c->factor[j][k];
    }
}

/* ---- bases and scalings: rows of F */

/* F = B^T L. Copies: B = 1. Sign: a function's row is the sum of the copies' rows times its values there. */
static void change_basis(const cube *c, int sign, matrix f) {
    size_t i, j, r, k, n = 3 * c->count;
    memcpy(f, c->factor, sizeof c->factor);
    for (i = 0; sign && i < n; i++)
        for (r = i % 3, k = 0; k < n; k++)
            for (f[i][k] = 0, j = 0; j < c->count; j++) f[i][k] += c->sign[i / 3][j] * c->factor[3 * j + r][k];
}

/* The share of its node's one-ring on which a free copy, or a function of RXFEM, is not 0. It is 1 where the node's
   other copy follows others. */
static real volume_share(const cube *c, size_t at, int sign) {
    real support = 0, ring = 0;
    size_t i, node = COPIES;
    for (i = 0; i < c->count && node == COPIES; i++)
        if (sign ? c->sign[at][i] != 0 : i == at) node = c->node[i];
    for (i = 0; i < c->count; i++)
        if (c->node[i] == node) {
            ring += c->volume[i];
            support += sign ? (c->sign[at][i] != 0) * c->volume[i] : (i == at) * c->volume[i];
        }
    return support / ring;
}

/* Divides rows by their norms, which are the roots of A's diagonal. */
static void scale_diagonal(const cube *c, matrix f) {
    size_t i, k, n = 3 * c->count;
    for (i = 0; i < n; i++) {
        real sum = 0;
        for (k = 0; k < n; k++) sum += f[i][k] * f[i][k];
        sum = sqrtl(sum);
        for (k = 0; k < n; k++) f[i][k] /= sum;
    }
}

/* Makes the three rows of each block orthonormal [Gram-Schmidt, twice]: F is then that of S = the block's inverse
 * factor. */
static void scale_block(const cube *c, matrix f) {
    size_t i, j, k, n = 3 * c->count, pass;
    for (i = 0; i < n; i++) {
        real sum = 0;
        for (pass = 0; pass < 2; pass++)
            for (j = i - i % 3; j < i; j++) {
                real dot = 0;
                for (k = 0; k < n; k++) dot += f[i][k] * f[j][k];
                for (k = 0; k < n; k++) f[i][k] -= dot * f[j][k];
            }
        for (k = 0; k < n; k++) sum += f[i][k] * f[i][k];
        sum = sqrtl(sum);
        for (k = 0; k < n; k++) f[i][k] /= sum;
    }
}

static void scale_volume(const cube *c, int sign, matrix f) {
    size_t i, k, n = 3 * c->count;
    for (i = 0; i < n; i++) {
        real scale = 1 / sqrtl(volume_share(c, i / 3, sign));
        for (k = 0; k < n; k++) f[i][k] *= scale;
    }
}

/* ---- multigrid: L^T P L */

/* A solver that has linearised the cube at rest, to the precision of doubles: its first step, as the cube slowly
   grows */
static gxs_solver *cube_solver(const cube *c) {
    double u[SIZE] = {0}, v[SIZE];
    gxs_solver_desc desc;
    gxs_step_desc step;
    gxs_solver *solver;
    size_t i;
    memset(&desc, 0, sizeof desc);
    memset(&step, 0, sizeof step);
    desc.preconditioner = GXS_MULTIGRID;
    for (i = 0; i < 3 * c->model.copy_count; i++) v[i] = 1e-6 * c->model.positions[i];
    step.dt = dt;
    expect(gxs_solver_create(&desc, &solver, NULL) == GX_OK && gxs_solver_set_model(solver, &c->model, NULL) == GX_OK,
           "no solver");
    expect(gxs_solver_step(solver, &step, u, v, NULL, NULL) == GX_OK, "no step");
    expect(solver->system->multigrid.level_count > 1, "the multigrid has no coarse level");
    return solver;
}

/* Column 3 j + r of P: of the unit vector of free copy j */
static void ask_cycle(const cube *c, gxs_solver *solver, matrix p) {
    gxsp_system *system = solver->system;
    gxsp_norms now;
    size_t i, j, r, k;
    for (j = 0; j < c->model.copy_count; j++)
        for (r = 0; r < 3 && !constraint_of(c, j); r++) {
            memset(system->vectors.residual, 0, 3 * system->model.n * sizeof(double));
            system->vectors.residual[3 * j + r] = 1;
            now = gxsp_scale(system, system->vectors.residual);
            (void)gxsp_precondition(system, 1 / (dt * dt), now.energy);
            for (i = 0; i < c->model.copy_count; i++)
                for (k = 0; k < 3 && !constraint_of(c, i); k++)
                    p[3 * c->free[i] + k][3 * c->free[j] + r] =
                        system->model.scale / (dt * dt) * (real)system->vectors.scaled[i][k];
        }
}

/* f = a b, or a^T b */
static void multiply(size_t n, matrix a, int transposed, matrix b, matrix f) {
    size_t i, j, k;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++)
            for (f[i][j] = 0, k = 0; k < n; k++) f[i][j] += (transposed ? a[k][i] : a[i][k]) * b[k][j];
}

/* Takes the motion of whole fragments, L^T t, out of the rows of f, and puts it back with the eigenvalue 1. */
static void translate(const cube *c, matrix f) {
    size_t n = 3 * c->count, piece, r, i, k;
    for (piece = 0; piece < c->fragments; piece++)
        for (r = 0; r < 3; r++) {
            real t[SIZE] = {0}, norm = 0;
            for (i = 0; i < c->count; i++)
                for (k = 0; k < n && c->fragment[i] == piece; k++) t[k] += c->factor[3 * i + r][k];
            for (k = 0; k < n; k++) norm += t[k] * t[k];
            for (i = 0; i < n; i++) {
                real dot = 0;
                for (k = 0; k < n; k++) dot += f[i][k] * t[k];
                for (k = 0; k < n; k++) f[i][k] += (t[i] - dot) * t[k] / norm;
            }
        }
}

/* F = L^T P L, whose eigenvalues are those of P A */
static void cycle(const cube *c, matrix f) {
    static matrix p, product;
    gxs_solver *solver = cube_solver(c);
    ask_cycle(c, solver, p);
    multiply(3 * c->count, p, 0, (real(*)[SIZE])c->factor, product);
    multiply(3 * c->count, (real(*)[SIZE])c->factor, 1, product, f);
    translate(c, f);
    gxs_solver_destroy(solver);
}

/* ---- singular values */

/* Turns columns p and q of f so that they are orthogonal; 0 if they were. */
static int rotate(matrix f, size_t n, size_t p, size_t q) {
    real a = 0, b = 0, g = 0, zeta, t, cosine, sine;
    size_t i;
    for (i = 0; i < n; i++) {
        a += f[i][p] * f[i][p];
        b += f[i][q] * f[i][q];
        g += f[i][p] * f[i][q];
    }
    if (fabsl(g) <= 1e-18L * sqrtl(a) * sqrtl(b)) return 0;
    zeta = (b - a) / (2 * g);
    t = (zeta > 0 ? 1 : -1) / (fabsl(zeta) + sqrtl(1 + zeta * zeta));
    cosine = 1 / sqrtl(1 + t * t);
    sine = cosine * t;
    for (i = 0; i < n; i++) {
        real x = f[i][p], y = f[i][q];
        f[i][p] = cosine * x - sine * y;
        f[i][q] = sine * x + cosine * y;
    }
    return 1;
}

/* Of F F^T: the squared ratio of F's largest singular value to the smallest */
static real condition(matrix f, size_t n) {
    real least = 0, largest = 0;
    size_t p, q, i;
    int turned = 1, sweep;
    for (sweep = 0; sweep < 100 && turned; sweep++)
        for (turned = 0, p = 0; p < n; p++)
            for (q = p + 1; q < n; q++) turned |= rotate(f, n, p, q);
    expect(!turned, "Jacobi's sweeps do not end");
    for (p = 0; p < n; p++) {
        real sum = 0;
        for (i = 0; i < n; i++) sum += f[i][p] * f[i][p];
        largest = sum > largest ? sum : largest;
        least = p == 0 || sum < least ? sum : least;
    }
    return largest / least;
}

/* ---- the table: some of the cases */

enum { SCALINGS = 5, SHOWN = 6, RUNS = 41 };

static const char *const scaling[SCALINGS] = {"none", "diagonal", "block", "volume", "multigrid"};
static const struct {
    const char *name;
    double eps;
} shown[SHOWN] = {{"uncut", 0}, {"slice", 0.1}, {"slice", 1e-6}, {"slice", 1e-12}, {"corner", 1e-6}, {"corner", 1e-12}};
static real table[2][2][SCALINGS][SHOWN]; /* by extension and basis; 0: not in the case */
static size_t runs;

static void keep(const char *name, double eps, int extended, int sign, int k, real number) {
    int i;
    for (i = 0; i < SHOWN; i++)
        if (strcmp(shown[i].name, name) == 0 && fabs(eps - shown[i].eps) <= 1e-3 * eps)
            table[extended][sign][k][i] = number;
}

static void print_table(void) {
    int extended, sign, k, i;
    fprintf(stderr, "%-8s %-9s %-9s", "basis", "scaling", "extension");
    for (i = 0; i < SHOWN; i++) fprintf(stderr, " %7s %-6.0e", shown[i].name, shown[i].eps);
    for (extended = 0; extended < 2; extended++)
        for (sign = 0; sign < 2; sign++)
            for (k = 0; k < SCALINGS - sign; k++) {
                fprintf(stderr, "\n%-8s %-9s %-9s", sign ? "sign" : "copies", scaling[k], extended ? "on" : "off");
                for (i = 0; i < SHOWN; i++)
                    if (table[extended][sign][k][i] > 0)
                        fprintf(stderr, " %14.2Le", table[extended][sign][k][i]);
                    else
                        fprintf(stderr, "%15s", "");
            }
    fprintf(stderr, "\n");
}

/* ---- cases */

static void rows(const cube *c, const char *name, double eps, int extended) {
    static matrix f;
    int sign, k;
    for (sign = 0; sign < 2; sign++)
        for (k = 0; k < SCALINGS - sign; k++) { /* multigrid: copies only */
            real number;
            change_basis(c, sign, f);
            if (k == 1)
                scale_diagonal(c, f);
            else if (k == 2)
                scale_block(c, f);
            else if (k == 3)
                scale_volume(c, sign, f);
            else if (k == 4)
                cycle(c, f);
            number = condition(f, 3 * c->count);
            number = k == 4 ? sqrtl(number) : number;
            keep(name, eps, extended, sign, k, number);
            csv_row("%s,%.6g,%s,%s,%s,%.6Le", name, eps, sign ? "sign" : "copies", scaling[k], extended ? "on" : "off",
                    number);
        }
}

/* points and plane: NULL for the uncut cube */
static void run(const char *name, double eps, const double *points, const double *plane, int extended) {
    static cube c;
    gx_view view;
    size_t e;
    memset(&c, 0, sizeof c);
    progress_draw("conditioning", runs++, RUNS, name);
    cube_create(&c, extended ? 0.5 : 1e-300);
    if (points) cube_cut(&c, points);
    expect(gx_body_view(c.body, &view, NULL) == GX_OK && gx_body_model(c.body, &c.model, NULL) == GX_OK, "no model");
    expect(view.copy_count <= COPIES, "more copies than there is room for");
    cube_number(&c, &view);
    cube_enrich(&c, &view, points, plane);
    for (e = 0; e < c.model.element_count; e++) add_element(&c, &c.model.elements[e]);
    cube_factor(&c);
    rows(&c, name, eps, extended);
    gx_body_destroy(c.body);
}

static void slice(double eps) {
    double x = 1 - eps, points[9] = {0, -9, -9, 0, 9, -9, 0, 0, 9}, plane[4] = {1, 0, 0, 0};
    points[0] = points[3] = points[6] = plane[3] = x;
    run("slice", 1 - x, points, plane, 0);
}

/* The corner (1, -1, -1), which is in one element only: the plane meets its three edges, of length 2, at the share
 * eps^(1/3). */
static void corner_piece(double eps) {
    double cut = 2 * cbrt(eps), points[9], plane[4] = {-1, 1, 1, 0};
    size_t i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) /* from the point on edge i along the plane's triangle to far outside */
            points[3 * i + k] = (k == 0 ? 1 : -1) + (k == 0 ? -1 : 1) * ((k == i ? cut : 0) + 8 * (3.0 * (k == i) - 1));
    plane[3] = -1 - 1 - 1 + cut;
    run("corner", eps, points, plane, 0);
    run("corner", eps, points, plane, 1);
}

int main(int argc, char **argv) {
    static const double wide[] = {1, 0.75, 0.5, 0.25};
    int small;
    const char *path = csv_arguments(argc, argv, &small);
    size_t i;
    csv_open(argv[0], path, "case,eps,basis,scaling,extension,condition");
    rules = rx_rules_create(2, 0);
    run("uncut", 0, NULL, NULL, 0);
    for (i = 0; i < sizeof wide / sizeof wide[0]; i++) slice(wide[i]);
    for (i = 1; i <= 12; i++) slice(pow(10, -(double)i));
    for (i = 1; i <= 12; i++) corner_piece(pow(10, -(double)i));
    progress_draw("conditioning", runs, RUNS, "");
    print_table();
    rx_rules_destroy(rules);
    return csv_close();
}
