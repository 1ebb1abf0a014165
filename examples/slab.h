/* slab.h: what the scenes of sliced slabs are judged by. Include after scene.h.

   A slab of nx x ny x 1 cubes of 5 tetrahedra is held at x = 0 and sliced by planes across z, then perhaps by one
   across x. Slices are boxes, so that everything can be found a second time without the library:
   - integrals: each tetrahedron is clipped by the slice's planes and sampled by thousands of points (slab_sample);
   - the space: the same slices in finer meshes, slices meshed on their own, and with affine copies (slab_study).
   The first must agree to rounding; beside it stands what virtual nodes give, replicas with all of an element's mass
   and stiffness. The second does not: slices thinner than an element bend too little, which is the locking of linear
   elements and no error of integration. With affine copies (gx_body_desc.affine_below) they bend. */
#ifndef SLAB_H
#define SLAB_H

#include "scene.h"
#include "../bench/vna.h"

/* ---- integrals by brute force ---- */

typedef struct slab_box {
    double low[3], high[3];
} slab_box;

/* Barycentric coordinates of the corners of a part of a tetrahedron */
typedef struct slab_simplex {
    double at[4][4];
} slab_simplex;

/* int 1, int N_i N_j in the order of gxs_element.mass */
typedef struct slab_sum {
    double volume, product[10];
    size_t points;
} slab_sum;

/* Adds the four points of the rule of degree 2 [Hammer and Stroud 1956]; share: of the tetrahedron's volume, per point.
 */
static void slab_add_points(const slab_simplex *part, double share, slab_sum *sum) {
    /* (5 + 3 sqrt 5) / 20, (5 - sqrt 5) / 20 */
    static const double near = 0.58541019662496845, far = 0.13819660112501052;
    int p, c, i, j, k;
    for (p = 0; p < 4; p++) {
        double n[4];
        for (i = 0; i < 4; i++)
            for (c = 0, n[i] = 0.0; c < 4; c++) n[i] += (c == p ? near : far) * part->at[c][i];
        for (i = 0, k = 0; i < 4; i++)
            for (j = i; j < 4; j++) sum->product[k++] += share * n[i] * n[j];
        sum->volume += share;
        sum->points++;
    }
}

static void slab_middle(const double a[4], const double b[4], double middle[4]) {
    int i;
    for (i = 0; i < 4; i++) middle[i] = 0.5 * (a[i] + b[i]);
}

/* Divides a simplex into eight of equal volume, `depth` times, and adds their points. */
static void slab_subdivide(const slab_simplex *part, double share, int depth, slab_sum *sum) {
    /* corners 0-3, then the middles of 01 02 03 12 13 23 */
    static const unsigned char child[8][4] = {{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3},
                                              {4, 5, 6, 8}, {4, 5, 7, 8}, {5, 6, 8, 9}, {5, 7, 8, 9}};
    double point[10][4];
    int i, j, k = 4;
    if (depth == 0) {
        slab_add_points(part, share / 4.0, sum);
        return;
    }
    memcpy(point, part->at, sizeof part->at);
    for (i = 0; i < 4; i++)
        for (j = i + 1; j < 4; j++) slab_middle(point[i], point[j], point[k++]);
    for (i = 0; i < 8; i++) {
        slab_simplex smaller;
        for (j = 0; j < 4; j++) memcpy(smaller.at[j], point[child[i][j]], sizeof smaller.at[j]);
        slab_subdivide(&smaller, share / 8.0, depth - 1, sum);
    }
}

/* Six times the share that a simplex has of its tetrahedron's volume: the determinant of its coordinates */
static double slab_share(const slab_simplex *part) {
    double d[3][3];
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) d[i][j] = part->at[i + 1][j + 1] - part->at[0][j + 1];
    return fabs(d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]));
}

/* x: the element's corners */
typedef struct slab_clip {
    const double *x[4];
    slab_box box;
    int depth;
    double volume;
    slab_sum *sum;
} slab_clip;

/* How far a corner is inside the plane, 0 to 5, of the box */
static double slab_inside(const slab_clip *clip, int plane, const double at[4]) {
    const int axis = plane / 2;
    double x = 0.0;
    int i;
    for (i = 0; i < 4; i++) x += at[i] * clip->x[i][axis];
    return plane % 2 ? clip->box.high[axis] - x : x - clip->box.low[axis];
}

static void slab_clip_by(const slab_clip *clip, int plane, const slab_simplex *part);

/* The wedge between triangles a and b, as three simplices */
static void slab_clip_wedge(const slab_clip *clip, int plane, double a[3][4], double b[3][4]) {
    slab_simplex part;
    int i, k;
    for (i = 0; i < 3; i++) {
        for (k = 0; k < 3 - i; k++) memcpy(part.at[k], a[i + k], sizeof part.at[k]);
        for (k = 0; k <= i; k++) memcpy(part.at[3 - i + k], b[k], sizeof part.at[k]);
        slab_clip_by(clip, plane, &part);
    }
}

/* What is inside the planes from `plane` on: a simplex again, or a wedge, by how many corners are inside. */
static void slab_clip_by(const slab_clip *clip, int plane, const slab_simplex *part) {
    double inside[4], in[4][4], out[4][4], in_by[4], out_by[4], cut[4][4], a[3][4], b[3][4];
    int ins = 0, outs = 0, i, j, k;
    if (plane == 6) {
        slab_subdivide(part, slab_share(part) * clip->volume, clip->depth, clip->sum);
        return;
    }
    for (i = 0; i < 4; i++) {
        inside[i] = slab_inside(clip, plane, part->at[i]);
        if (inside[i] > 0.0) {
            memcpy(in[ins], part->at[i], sizeof in[0]);
            in_by[ins++] = inside[i];
        } else {
            memcpy(out[outs], part->at[i], sizeof out[0]);
            out_by[outs++] = inside[i];
        }
    }
    if (ins == 0) return;
    if (outs == 0) {
        slab_clip_by(clip, plane + 1, part);
        return;
    }
    for (i = 0, k = 0; i < ins; i++)
        for (j = 0; j < outs; j++, k++) {
            int c;
            for (c = 0; c < 4; c++) cut[k][c] = (in_by[i] * out[j][c] - out_by[j] * in[i][c]) / (in_by[i] - out_by[j]);
        }
    if (ins == 1) {
        slab_simplex corner;
        memcpy(corner.at[0], in[0], sizeof in[0]);
        memcpy(corner.at[1], cut, 3 * sizeof cut[0]);
        slab_clip_by(clip, plane + 1, &corner);
        return;
    }
    if (ins == 3) {
        memcpy(a, in, sizeof a);
        memcpy(b, cut, sizeof b);
    } else { /* two in, two out: the wedge's triangles are at the two corners that are in */
        memcpy(a[0], in[0], sizeof a[0]);
        memcpy(a[1], cut[0], sizeof a[0]);
        memcpy(a[2], cut[1], sizeof a[0]);
        memcpy(b[0], in[1], sizeof b[0]);
        memcpy(b[1], cut[2], sizeof b[0]);
        memcpy(b[2], cut[3], sizeof b[0]);
    }
    slab_clip_wedge(clip, plane + 1, a, b);
}

/* Volume and mass integrals of an element's part in a box, by points: 4 x 8^depth for each simplex that clipping leaves
 */
static slab_sum slab_sample(const gxio_mesh *mesh, uint32_t element, const slab_box *box, int depth) {
    slab_simplex whole;
    slab_clip clip;
    slab_sum sum;
    int i;
    memset(&sum, 0, sizeof sum);
    memset(&whole, 0, sizeof whole);
    for (i = 0; i < 4; i++) {
        whole.at[i][i] = 1.0;
        clip.x[i] = mesh->positions + 3 * (size_t)mesh->elements[4 * (size_t)element + (size_t)i];
    }
    clip.box = *box;
    clip.depth = depth;
    clip.volume = gxio_element_determinant(mesh->positions, mesh->elements + 4 * (size_t)element) / 6.0;
    clip.sum = &sum;
    slab_clip_by(&clip, 0, &whole);
    return sum;
}

/* ---- slices ---- */

/* A sliced body, as it is now */
typedef struct slab {
    scene *s;
    const gxio_mesh *mesh;
    gx_body *body;
    gx_view view;
    gxs_model model;
    double density;        /* kg/m3 */
    gxs_element *elements; /* of fragments that are held; owned */
    size_t element_count;
    uint32_t *fragment; /* copy_count: of each copy; owned */
    uint8_t *held;      /* fragment_count: is any of it held? owned */
} slab;

static void slab_release(slab *b) {
    free(b->elements);
    free(b->fragment);
    free(b->held);
}

static slab slab_take(scene *s, const gxio_mesh *mesh, gx_body *body, double density) {
    slab b;
    size_t i;
    memset(&b, 0, sizeof b);
    b.s = s;
    b.mesh = mesh;
    b.body = body;
    b.density = density;
    scene_must(s, gx_body_view(body, &b.view, &s->failure), "view");
    scene_must(s, gx_body_model(body, &b.model, &s->failure), "model");
    b.fragment = (uint32_t *)scene_array(s, b.view.copy_count, sizeof *b.fragment);
    b.held = (uint8_t *)scene_array(s, b.view.fragment_count, 1);
    b.elements = (gxs_element *)scene_array(s, b.model.element_count, sizeof *b.elements);
    for (i = 0; i < 4 * b.view.cell_count; i++) b.fragment[b.view.cell_copies[i]] = b.view.cell_fragment[i / 4];
    for (i = 0; i < b.view.copy_count; i++)
        if (b.view.copy_held[i]) b.held[b.fragment[i]] = 1;
    for (i = 0; i < b.model.element_count; i++)
        if (b.held[b.fragment[b.model.elements[i].copy[0]]]) b.elements[b.element_count++] = b.model.elements[i];
    return b;
}

/* The box between planes across x and z that a fragment is in; planes in ascending order. */
static slab_box slab_box_of(const slab *b, size_t fragment, const double *z, size_t z_count, const double *x,
                            size_t x_count) {
    const double *center = b->view.fragment_center + 3 * fragment;
    slab_box box;
    size_t i;
    gxio_bounds(b->mesh->positions, b->mesh->node_count, box.low, box.high);
    for (i = 0; i < z_count; i++)
        if (z[i] < center[2])
            box.low[2] = z[i];
        else {
            box.high[2] = z[i];
            break;
        }
    for (i = 0; i < x_count; i++)
        if (x[i] < center[0])
            box.low[0] = x[i];
        else {
            box.high[0] = x[i];
            break;
        }
    return box;
}

/* Gradients of the four shape functions, 1/m: the inverse of the edges' matrix */
static void slab_gradients(const gxio_mesh *mesh, uint32_t element, double gradient[4][3]) {
    const uint32_t *corner = mesh->elements + 4 * (size_t)element;
    const double determinant = gxio_element_determinant(mesh->positions, corner);
    double d[3][3];
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            d[i][j] = mesh->positions[3 * (size_t)corner[i + 1] + (size_t)j] -
                      mesh->positions[3 * (size_t)corner[0] + (size_t)j];
    for (i = 0; i < 3; i++) {
        const double *a = d[(i + 1) % 3], *b = d[(i + 2) % 3];
        for (j = 0; j < 3; j++)
            gradient[i + 1][j] = (a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3]) / determinant;
    }
    for (j = 0; j < 3; j++) gradient[0][j] = -(gradient[1][j] + gradient[2][j] + gradient[3][j]);
}

/* The same elements by points: one for each cell of a held fragment, in boxes[fragment]. To be freed by the caller.
   points: written, how many there are in all. */
static gxs_element *slab_sampled_elements(const slab *b, const slab_box *boxes, int depth, size_t *count,
                                          size_t *points) {
    gxs_element *elements = (gxs_element *)scene_array(b->s, b->view.cell_count, sizeof *elements);
    size_t cell, i;
    *count = 0;
    *points = 0;
    for (cell = 0; cell < b->view.cell_count; cell++) {
        const uint32_t fragment = b->view.cell_fragment[cell], e = b->view.cell_element[cell];
        gxs_element *element = &elements[*count];
        slab_sum sum;
        if (!b->held[fragment]) continue;
        sum = slab_sample(b->mesh, e, &boxes[fragment], depth);
        memcpy(element->copy, b->view.cell_copies + 4 * cell, sizeof element->copy);
        slab_gradients(b->mesh, e, element->gradient);
        element->weight = sum.volume;
        for (i = 0; i < 10; i++) element->mass[i] = b->density * sum.product[i];
        *points += sum.points;
        (*count)++;
    }
    return elements;
}

/* Displacements at which held fragments made of `elements` rest, copy_count x 3, from the start given or from 0. Others
   stay. To be freed by the caller. tolerance: as gxs_step_desc.newton_tolerance. */
static double *slab_rest(const slab *b, const gxs_element *elements, size_t count, const gx_step_desc *like,
                         double tolerance, const double *start) {
    double *displacement = (double *)scene_array(b->s, b->view.copy_count, 3 * sizeof(double));
    double *velocity = (double *)scene_array(b->s, b->view.copy_count, 3 * sizeof(double));
    gxs_solver *solver;
    gxs_model model = b->model;
    gxs_step_desc step;
    memset(&step, 0, sizeof step);
    memcpy(step.gravity, like->gravity, sizeof step.gravity);
    step.integrator = GXS_STATIC;
    step.newton_iterations = 1000;
    step.newton_tolerance = tolerance;
    step.cg_tolerance = 1e-4;
    model.elements = elements;
    model.element_count = count;
    if (start) memcpy(displacement, start, 3 * b->view.copy_count * sizeof(double));
    scene_must(b->s, gxs_solver_create(NULL, &solver, &b->s->failure), "solver");
    scene_must(b->s, gxs_solver_set_model(solver, &model, &b->s->failure), "model");
    scene_must(b->s, gxs_solver_step(solver, &step, displacement, velocity, NULL, &b->s->failure), "rest");
    gxs_solver_destroy(solver);
    free(velocity);
    return displacement;
}

/* Barycentric coordinates of a point in an element */
static void slab_locate(const gxio_mesh *mesh, uint32_t element, const double point[3], double at[4]) {
    const double *origin = mesh->positions + 3 * (size_t)mesh->elements[4 * (size_t)element];
    double gradient[4][3];
    int i, j;
    slab_gradients(mesh, element, gradient);
    for (i = 0; i < 4; i++)
        for (j = 0, at[i] = i == 0 ? 1.0 : 0.0; j < 3; j++) at[i] += gradient[i][j] * (point[j] - origin[j]);
}

/* How far a material point of a fragment has gone down, m */
static double slab_drop(const slab *b, size_t fragment, const double point[3], const double *displacement) {
    double best = -1.0, drop = 0.0;
    size_t cell;
    int i;
    for (cell = 0; cell < b->view.cell_count; cell++) {
        double at[4], least, sum = 0.0;
        if (b->view.cell_fragment[cell] != fragment) continue;
        slab_locate(b->mesh, b->view.cell_element[cell], point, at);
        least = fmin(fmin(at[0], at[1]), fmin(at[2], at[3]));
        if (least <= best) continue; /* the element that the point is in, or is closest to by rounding */
        for (i = 0; i < 4; i++) sum += at[i] * displacement[3 * (size_t)b->view.cell_copies[4 * cell + (size_t)i] + 2];
        best = least;
        drop = -sum;
    }
    return drop;
}

/* Which slice, counted from below, a box is: the number of planes that are not above it */
static size_t slab_slice_of(const slab_box *box, const double *z, size_t z_count) {
    size_t i = 0;
    while (i < z_count && z[i] <= box->low[2]) i++;
    return i;
}

/* How far the drops of the same slices are off by element duplication: the largest share of the right one */
static double slab_duplicated(const slab *b, const gx_step_desc *like, const double *rest, const double (*points)[3]) {
    gxs_element *replicas = (gxs_element *)scene_array(b->s, b->element_count, sizeof *replicas);
    double *other, worst = 0.0;
    size_t f;
    vna_replicate(b->elements, b->element_count, &b->density, replicas);
    other = slab_rest(b, replicas, b->element_count, like, 1e-10, b->view.displacement);
    for (f = 0; f < b->view.fragment_count; f++)
        if (b->held[f])
            worst = fmax(worst, fabs(slab_drop(b, f, points[f], other) / slab_drop(b, f, points[f], rest) - 1.0));
    free(other);
    free(replicas);
    return worst;
}

/* Drops at rest of the held slices at distance x from the wall, in the middle of width and thickness, from below:
   z_count + 1 of them. Checks them against integrals by points. x_cut: a plane across x, NULL: none yet. */
static void slab_judge(scene *s, const double *z, size_t z_count, const double *x_cut, double x, const char *when,
                       double *drops) {
    enum { DEPTH = 3 }; /* 2048 points for each simplex that clipping leaves */
    slab b = slab_take(s, &s->mesh, s->body, s->body_desc.density);
    slab_box *boxes = (slab_box *)scene_array(s, b.view.fragment_count, sizeof *boxes);
    double(*middle)[3] = (double(*)[3])scene_array(s, b.view.fragment_count, sizeof *middle);
    size_t f, sampled_count, points;
    gxs_element *sampled;
    double *rest, *again, worst = 0.0;
    for (f = 0; f < b.view.fragment_count; f++) boxes[f] = slab_box_of(&b, f, z, z_count, x_cut, x_cut != NULL);
    sampled = slab_sampled_elements(&b, boxes, DEPTH, &sampled_count, &points);
    rest = slab_rest(&b, b.elements, b.element_count, &s->step, 1e-13, b.view.displacement);
    again = slab_rest(&b, sampled, sampled_count, &s->step, 1e-13, b.view.displacement);
    for (f = 0; f < b.view.fragment_count; f++) {
        const slab_box *box = &boxes[f];
        double *drop = &drops[slab_slice_of(box, z, z_count)];
        middle[f][0] = x;
        middle[f][1] = 0.5 * (box->low[1] + box->high[1]);
        middle[f][2] = 0.5 * (box->low[2] + box->high[2]);
        if (!b.held[f]) continue;
        *drop = slab_drop(&b, f, middle[f], rest);
        worst = fmax(worst, fabs(*drop / slab_drop(&b, f, middle[f], again) - 1.0));
    }
    scene_check(s, worst <= 1e-10, "%s: drops against integrals by %lu points a cell: %.1e (at most 1e-10)", when,
                (unsigned long)(points / sampled_count), worst);
    scene_say(s, "%s: drops by element duplication (VNA) are off by up to %.1f %%", when,
              100 * slab_duplicated(&b, &s->step, rest, (const double(*)[3])middle));
    free(rest);
    free(again);
    free(sampled);
    free(boxes);
    free(middle);
    slab_release(&b);
}

/* ---- the space ---- */

/* What a study compares: a strip of the slab, one cube wide, sliced by the same planes */
typedef struct slab_strip {
    uint32_t cubes; /* from the wall to the end */
    double edge;    /* of a cube, m */
    /* m, ascending */
    const double *z;
    size_t z_count;
    size_t most_elements; /* of a mesh */
    FILE *csv;            /* slab_study's own; NULL: none is written */
    /* slab_study's own, SLAB_SPACES x (z_count + 1): of beam theory's drop on the last mesh, by space and slice */
    double *share;
    /* slab_study's own: meshes after a slice's first; those that bent it further, but not too far */
    size_t meshes, further;
    double stiffest; /* slab_study's own: the least share with affine copies in the slab's own mesh */
} slab_strip;

/* The slab's own space, cut; a slice's mesh; the first with affine copies */
enum { SLAB_CUT, SLAB_CONFORMING, SLAB_AFFINE, SLAB_SPACES };

/* A grid of nx x ny x nz cubes to fill length, width and thickness, held at x = 0, of small-strain elastic material.
   affine_below: as gx_body_desc */
static gx_body *slab_make_grid(scene *s, gxio_mesh *mesh, const uint32_t n[3], const double size[3],
                               double affine_below) {
    const gx_region wall = gx_region_half_space(0, -1, 1e-9);
    gx_body_desc desc;
    gx_material material;
    gx_body *body;
    char spec[64];
    size_t i;
    snprintf(spec, sizeof spec, "grid:%lu,%lu,%lu", (unsigned long)n[0], (unsigned long)n[1], (unsigned long)n[2]);
    if (!gxio_mesh_load(spec, mesh, &s->error)) scene_quit(s, SCENE_WRONG);
    for (i = 0; i < 3 * mesh->node_count; i++) mesh->positions[i] *= size[i % 3] / n[i % 3];
    memset(&desc, 0, sizeof desc);
    memset(&material, 0, sizeof material);
    material.elastic.kind = GXS_LINEAR;
    material.elastic.young = s->body_desc.young;
    material.elastic.poisson = s->body_desc.poisson;
    material.density = s->body_desc.density;
    desc.positions = mesh->positions;
    desc.node_count = mesh->node_count;
    desc.elements = mesh->elements;
    desc.element_count = mesh->element_count;
    desc.materials = &material;
    desc.material_count = 1;
    desc.affine_below = affine_below;
    scene_must(s, gx_body_create(&desc, &body, &s->failure), "body");
    scene_must(s, gx_body_hold(body, &wall, 1, &s->failure), "hold");
    return body;
}

/* Drop of the end of a cantilever of length l and thickness t under its weight, by beam theory: rho g l^4 b t / (8 E
 * I), I = b t^3 / 12 */
static double slab_beam_drop(const scene *s, double l, double t) {
    return 1.5 * s->body_desc.density * -s->step.gravity[2] * l * l * l * l / (s->body_desc.young * t * t);
}

static void slab_report(scene *s, slab_strip *strip, int space, size_t slice, uint32_t refinement, double thickness,
                        size_t unknowns, double drop) {
    static const char *const names[SLAB_SPACES] = {"cut", "conforming", "affine"};
    const double share = drop / slab_beam_drop(s, strip->cubes * strip->edge, thickness),
                 relative = thickness / strip->edge;
    double *last = &strip->share[(size_t)space * (strip->z_count + 1) + slice];
    scene_say(s, "%-10s %6lu %6.3f %10lu %10lu %8.1f %%", names[space], (unsigned long)slice, relative,
              (unsigned long)refinement, (unsigned long)unknowns, 100.0 * share);
    if (strip->csv)
        fprintf(strip->csv, "%s,%s,%lu,%.6g,%lu,%lu,%.6g\n", s->desc.name, names[space], (unsigned long)slice, relative,
                (unsigned long)refinement, (unsigned long)unknowns, share);
    strip->meshes += *last > 0.0;
    strip->further += *last > 0.0 && share > *last && share < 1.01;
    *last = share;
}

static size_t slab_count_unknowns(const slab *b, size_t fragment) {
    size_t c, count = 0;
    for (c = 0; c < b->view.copy_count; c++) count += b->fragment[c] == fragment;
    return 3 * count;
}

/* Drops of the ends of all fragments at rest: slices between the planes z, numbered from `first` */
static void slab_study_body(scene *s, slab_strip *strip, int space, size_t first, uint32_t refinement,
                            const gxio_mesh *mesh, gx_body *body, const double *z, size_t z_count) {
    slab b = slab_take(s, mesh, body, s->body_desc.density);
    double *rest = slab_rest(&b, b.elements, b.element_count, &s->step, 1e-6, NULL);
    size_t f;
    for (f = 0; f < b.view.fragment_count; f++) {
        const slab_box box = slab_box_of(&b, f, z, z_count, NULL, 0);
        const double end[3] = {box.high[0], 0.5 * (box.low[1] + box.high[1]), 0.5 * (box.low[2] + box.high[2])};
        slab_report(s, strip, space, first + slab_slice_of(&box, z, z_count), refinement, box.high[2] - box.low[2],
                    slab_count_unknowns(&b, f), slab_drop(&b, f, end, rest));
    }
    free(rest);
    slab_release(&b);
}

/* The same with affine copies, by steps of the body and anchors */
static void slab_study_affine(scene *s, slab_strip *strip, uint32_t refinement, const gxio_mesh *mesh, gx_body *body) {
    slab b = slab_take(s, mesh, body, s->body_desc.density);
    gx_anchor *ends = (gx_anchor *)scene_array(s, b.view.fragment_count, sizeof *ends);
    gx_step_desc step = s->step;
    size_t f, c;
    step.integrator = GXS_STATIC;
    step.dt = 0.0;
    step.newton_iterations = 1000;
    step.newton_tolerance = 1e-6;
    step.cg_iterations = 20000;
    step.cg_tolerance = 1e-4;
    for (f = 0; f < b.view.fragment_count; f++) {
        const slab_box box = slab_box_of(&b, f, strip->z, strip->z_count, NULL, 0);
        const double end[3] = {box.high[0], 0.5 * (box.low[1] + box.high[1]), 0.5 * (box.low[2] + box.high[2])};
        gx_hit hit;
        scene_must(s, gx_body_locate(body, end, 1, &hit, &s->failure), "end");
        scene_must(s, gx_hit_anchor(body, &hit, &ends[f], &s->failure), "end");
    }
    scene_must(s, gx_body_step(body, &step, NULL, &s->failure), "rest");
    for (f = 0; f < b.view.fragment_count; f++) {
        const slab_box box = slab_box_of(&b, f, strip->z, strip->z_count, NULL, 0);
        size_t unknowns = slab_count_unknowns(&b, f);
        double at[3];
        for (c = 0; c < b.view.copy_count; c++)
            if (b.fragment[c] == f && b.view.copy_affine[c]) unknowns += 9;
        scene_must(s, gx_body_anchor_point(body, &ends[f], NULL, at, &s->failure), "end");
        slab_report(s, strip, SLAB_AFFINE, slab_slice_of(&box, strip->z, strip->z_count), refinement,
                    box.high[2] - box.low[2], unknowns, 0.5 * (box.low[2] + box.high[2]) - at[2]);
    }
    free(ends);
    slab_release(&b);
}

/* The strip's own space: cubes of 1/refinement of an edge, cut by the planes */
static void slab_study_cut(scene *s, slab_strip *strip, int space, uint32_t refinement) {
    const double size[3] = {strip->cubes * strip->edge, strip->edge, strip->edge};
    const uint32_t n[3] = {strip->cubes * refinement, refinement, refinement};
    gxio_mesh mesh;
    gx_body *body = slab_make_grid(s, &mesh, n, size, space == SLAB_AFFINE);
    size_t i;
    for (i = 0; i < strip->z_count; i++) {
        const double vertices[12] = {-size[0],    -size[1],    strip->z[i], 3 * size[0], -size[1],    strip->z[i],
                                     3 * size[0], 3 * size[1], strip->z[i], -size[0],    3 * size[1], strip->z[i]};
        static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
        gx_surface sheet;
        gx_cut_desc cut;
        memset(&sheet, 0, sizeof sheet);
        memset(&cut, 0, sizeof cut);
        sheet.vertices = vertices;
        sheet.vertex_count = 4;
        sheet.triangles = triangles;
        sheet.triangle_count = 2;
        cut.surfaces = &sheet;
        cut.surface_count = 1;
        scene_must(s, gx_body_cut(body, &cut, NULL, &s->failure), "cut");
    }
    if (space == SLAB_AFFINE)
        slab_study_affine(s, strip, refinement, &mesh, body);
    else
        slab_study_body(s, strip, SLAB_CUT, 0, refinement, &mesh, body, strip->z, strip->z_count);
    gx_body_destroy(body);
    gxio_mesh_release(&mesh);
}

/* One slice meshed on its own: `layers` cubes through its thickness, as wide and as long */
static void slab_study_slice(scene *s, slab_strip *strip, size_t slice, double thickness, uint32_t layers) {
    const double size[3] = {strip->cubes * strip->edge, strip->edge, thickness};
    const uint32_t n[3] = {(uint32_t)ceil(size[0] * layers / thickness - 1e-9),
                           (uint32_t)ceil(size[1] * layers / thickness - 1e-9), layers};
    gxio_mesh mesh;
    gx_body *body = slab_make_grid(s, &mesh, n, size, 0);
    slab_study_body(s, strip, SLAB_CONFORMING, slice, layers, &mesh, body, NULL, 0);
    gx_body_destroy(body);
    gxio_mesh_release(&mesh);
}

/* How far slices bend beside beam theory, in their own space under refinement and as meshes of their own */
static void slab_study(scene *s, slab_strip *strip) {
    uint32_t n;
    size_t i;
    if (s->trace) return; /* run for its cuts */
    strip->stiffest = 1.0;
    strip->share = (double *)scene_array(s, SLAB_SPACES * (strip->z_count + 1), sizeof *strip->share);
    if (s->csv) strip->csv = scene_open_file(s, s->csv, "a");
    scene_say(s, "locking: a strip of the slab, %lu x 1 x 1 cubes, small strain; drop of the end beside beam theory's",
              (unsigned long)strip->cubes);
    scene_say(s, "%-10s %6s %6s %10s %10s %10s", "mesh", "slice", "t/h", "refinement", "unknowns", "drop");
    for (n = 1; 5.0 * strip->cubes * n * n * n <= (double)strip->most_elements; n *= 2)
        slab_study_cut(s, strip, SLAB_CUT, n);
    slab_study_cut(s, strip, SLAB_AFFINE, 1);
    for (i = 0; i <= strip->z_count; i++)
        strip->stiffest = fmin(strip->stiffest, strip->share[SLAB_AFFINE * (strip->z_count + 1) + i]);
    for (i = 0; i <= strip->z_count; i++) {
        const double t = (i < strip->z_count ? strip->z[i] : strip->edge) - (i > 0 ? strip->z[i - 1] : 0.0),
                     slender = strip->edge / t;
        for (n = 1; 5.0 * strip->cubes * slender * slender * n * n * n <= (double)strip->most_elements; n *= 2)
            slab_study_slice(s, strip, i, t, n);
    }
    scene_check(
        s, strip->further == strip->meshes,
        "refined meshes that bend a slice further than the one before, at most 1 %% beyond beam theory: %lu (all %lu)",
        (unsigned long)strip->further, (unsigned long)strip->meshes);
    scene_check(
        s, strip->stiffest > 0.7,
        "with affine copies each slice drops by at least %.1f %% of beam theory, in the slab's own mesh (70 %%)",
        100.0 * strip->stiffest);
    if (s->csv) scene_close_file(s, s->csv, strip->csv);
    free(strip->share);
}

#endif /* SLAB_H */
