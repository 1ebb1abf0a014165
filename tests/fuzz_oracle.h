/* fuzz_oracle.h - what a Boolean of a few small surfaces must be, by oracle.h: space, as one large tetrahedron, divided by all planes. Pieces
   are inside or not by exact winding numbers; components are pieces joined across faces in which no sheet lies; the Euler characteristic is
   that of the faces between inside and outside (or at a sheet), joined around edges through the inside. */
#ifndef GXFEM_TESTS_FUZZ_ORACLE_H
#define GXFEM_TESTS_FUZZ_ORACLE_H

#include "fuzz_cases.h"
#include "oracle.h"

enum { FUZZ_ORACLE_PLANES = 22, FUZZ_ORACLE_PIECES = 900 };

typedef struct fuzz_truth {
    size_t components;
    long euler;
    double volume, part[FUZZ_ORACLE_PIECES];    /* part: of the components */
} fuzz_truth;

/* ---- faces of pieces ---- */

typedef struct fuzz_face {
    size_t piece, neighbour;        /* SIZE_MAX: there is none */
    size_t corners, corner_count;   /* into fuzz_faces.corner: points */
    int plane, open;                /* open: inside goes on behind it */
} fuzz_face;

typedef struct fuzz_faces {
    const oracle *o;
    fuzz_face *face; size_t count;
    size_t *corner; size_t corner_count;
    size_t *of;                     /* piece x plane: face, SIZE_MAX: none */
} fuzz_faces;

static inline size_t fuzz_face_at(const fuzz_faces *f, size_t piece, int plane) { return f->of[piece * f->o->plane_count + (size_t)plane]; }

static inline void fuzz_add_face(fuzz_faces *f, size_t piece, int plane) {
    const oracle_piece *p = &f->o->pieces[piece];
    fuzz_face *face;
    size_t i, on = 0;
    for (i = 0; i < p->point_count; ++i) on += (size_t)oracle_set_has(&oracle_corner(f->o, p, i)->zero, plane);
    if (on < 3) return;
    f->face = (fuzz_face *)oracle_grow(f->face, f->count, sizeof *f->face);
    face = &f->face[f->count];
    face->piece = piece; face->plane = plane; face->neighbour = SIZE_MAX; face->open = 0;
    face->corners = f->corner_count; face->corner_count = on;
    for (i = 0; i < p->point_count; ++i) {
        if (!oracle_set_has(&oracle_corner(f->o, p, i)->zero, plane)) continue;
        f->corner = (size_t *)oracle_grow(f->corner, f->corner_count, sizeof *f->corner);
        f->corner[f->corner_count++] = f->o->corners[p->points + i];
    }
    f->of[piece * f->o->plane_count + (size_t)plane] = f->count++;
}

static inline void fuzz_join_faces(fuzz_faces *f) {
    size_t i, j;
    for (i = 0; i < f->o->piece_count; ++i)
        for (j = 0; j < f->o->piece_count; ++j) {
            const int k = oracle_set_difference(&f->o->pieces[i].plus, &f->o->pieces[j].plus);
            size_t face;
            rat_mark mark = rat_arena_mark();
            oracle_set on = oracle_set_empty();
            oracle_contact c;
            if (i == j || k == ORACLE_NONE || f->o->pieces[i].removed || f->o->pieces[j].removed) continue;
            face = fuzz_face_at(f, i, k);
            oracle_set_add(&on, k);
            c = oracle_contact_of(f->o, &f->o->pieces[i], &on);
            f->face[face].neighbour = j;
            f->face[face].open = !oracle_covered(f->o, &c, 0);
            rat_arena_release(mark);
        }
}

static inline fuzz_faces fuzz_find_faces(const oracle *o) {
    fuzz_faces f;
    size_t i;
    int k;
    memset(&f, 0, sizeof f);
    f.o = o;
    f.of = (size_t *)oracle_memory(NULL, o->piece_count * o->plane_count, sizeof *f.of);
    for (i = 0; i < o->piece_count * o->plane_count; ++i) f.of[i] = SIZE_MAX;
    for (i = 0; i < o->piece_count; ++i)
        for (k = 0; k < (int)o->plane_count && !o->pieces[i].removed; ++k) fuzz_add_face(&f, i, k);
    fuzz_join_faces(&f);
    return f;
}

/* The other face of its piece around the edge between two points */
static inline size_t fuzz_turn(const fuzz_faces *f, size_t face, size_t a, size_t b) {
    const size_t piece = f->face[face].piece;
    int k;
    for (k = 0; k < (int)f->o->plane_count; ++k) {
        const size_t other = fuzz_face_at(f, piece, k);
        if (other != SIZE_MAX && other != face && oracle_set_has(&f->o->points[a].zero, k) && oracle_set_has(&f->o->points[b].zero, k)) return other;
    }
    rat_stop("oracle: an edge of one face");
    return 0;
}

static inline size_t fuzz_corner_of(const fuzz_faces *f, size_t face, size_t point) {
    size_t i = f->face[face].corners;
    while (f->corner[i] != point) ++i;
    return i;
}

/* Vertices - edges + faces of the boundary: corners of faces that meet around a vertex are one vertex. */
static inline long fuzz_euler(const oracle *o) {
    fuzz_faces f = fuzz_find_faces(o);
    size_t *parent = oracle_singles(f.corner_count), i, a, b, sides = 0;
    oracle_set done = oracle_done(o->plane_count);
    long euler = 0;
    for (i = 0; i < f.count; ++i) {
        const oracle_piece *p = &o->pieces[f.face[i].piece];
        if (f.face[i].open) continue;
        ++euler;
        for (a = 0; a < p->point_count; ++a) for (b = a + 1; b < p->point_count; ++b) {
            const size_t x = o->corners[p->points + a], y = o->corners[p->points + b];
            size_t mate;
            if (!oracle_set_has(&o->points[x].zero, f.face[i].plane) || !oracle_set_has(&o->points[y].zero, f.face[i].plane)) continue;
            if (!oracle_adjacent(o, p, a, b, &done)) continue;
            ++sides;
            mate = fuzz_turn(&f, i, x, y);
            while (f.face[mate].open) mate = fuzz_turn(&f, fuzz_face_at(&f, f.face[mate].neighbour, f.face[mate].plane), x, y);
            oracle_join(parent, fuzz_corner_of(&f, i, x), fuzz_corner_of(&f, mate, x));
            oracle_join(parent, fuzz_corner_of(&f, i, y), fuzz_corner_of(&f, mate, y));
        }
    }
    for (i = 0; i < f.count; ++i)
        for (a = f.face[i].corners; a < f.face[i].corners + f.face[i].corner_count; ++a) euler += !f.face[i].open && oracle_root(parent, a) == a;
    free(f.face); free(f.corner); free(f.of); free(parent);
    return euler - (long)(sides / 2);
}

/* ---- the whole ---- */

/* A tetrahedron around all operands */
static inline void fuzz_frame(const test_case *c, double x[4][3]) {
    double size = 0;
    size_t i, j;
    int k, e;
    for (i = 0; i < c->operands; ++i)
        for (j = 0; j < c->operand[i].mesh.vertices; ++j) for (k = 0; k < 3; ++k) size = fmax(size, fabs(c->operand[i].mesh.x[j][k]));
    frexp(size, &e);
    for (i = 0; i < 4; ++i) for (k = 0; k < 3; ++k) x[i][k] = ldexp((int)i == k + 1 ? 4 : -1, e + 1);
}

static inline void fuzz_choose_pieces(oracle *o, const test_case *c, int (*inside)(const case_operand *, size_t, const int32_t *)) {
    size_t *region = oracle_singles(o->piece_count), i, s;
    oracle_join_inside(o, region, 1);
    for (i = 0; i < o->piece_count; ++i) {
        int32_t winding[CASE_OPERANDS + CASE_SHEETS];
        rat_mark mark = rat_arena_mark();
        oracle_set nothing = oracle_set_empty();
        oracle_contact middle;
        o->pieces[i].region = oracle_root(region, i);
        if (o->pieces[i].region != i) { o->pieces[i].removed = o->pieces[o->pieces[i].region].removed; continue; }
        middle = oracle_contact_of(o, &o->pieces[i], &nothing);
        for (s = 0; s < c->operands; ++s) winding[s] = c->operand[s].operation == 4 ? 0 : oracle_winding(o, s, middle.center);
        o->pieces[i].removed = !inside(c->operand, c->operands, winding);
        rat_arena_release(mark);
    }
    free(region);
}

static inline void fuzz_read_pieces(oracle *o, fuzz_truth *truth) {
    size_t *component = oracle_singles(o->piece_count), *name = oracle_singles(o->piece_count), i;
    memset(truth, 0, sizeof *truth);
    oracle_join_inside(o, component, 0);
    for (i = 0; i < o->piece_count; ++i) {
        const size_t root = oracle_root(component, i);
        double volume;
        if (o->pieces[i].removed) continue;
        if (root == i) name[i] = truth->components++;
        volume = oracle_piece_volume(o, &o->pieces[i]);
        truth->part[name[root]] += volume;
        truth->volume += volume;
    }
    truth->euler = fuzz_euler(o);
    free(component); free(name);
}

/* 0: too large for it */
static inline int fuzz_ask_oracle(const test_case *c, int (*inside)(const case_operand *, size_t, const int32_t *), fuzz_truth *truth) {
    static const uint32_t nodes[4] = { 0, 1, 2, 3 };
    oracle_surface surfaces[CASE_OPERANDS + CASE_SHEETS];
    double frame[4][3];
    oracle *o = (oracle *)oracle_memory(NULL, 1, sizeof *o);
    int small;
    size_t i;
    memset(o, 0, sizeof *o);
    o->mark = rat_arena_mark();
    fuzz_frame(c, frame);
    o->mesh.positions = &frame[0][0]; o->mesh.node_count = 4;
    o->mesh.elements = nodes; o->mesh.element_count = 1;
    for (i = 0; i < c->operands; ++i) {
        surfaces[i].vertices = &c->operand[i].mesh.x[0][0];
        surfaces[i].triangles = &c->operand[i].mesh.t[0][0];
        surfaces[i].triangle_count = c->operand[i].mesh.triangles;
        surfaces[i].solid = c->operand[i].operation != 4;
    }
    oracle_find_planes(o, surfaces, c->operands);
    small = o->plane_count <= FUZZ_ORACLE_PLANES;
    if (small) {
        o->element_pieces = (size_t *)oracle_memory(NULL, 2, sizeof *o->element_pieces);
        o->element_pieces[0] = 0;
        oracle_divide_element(o, 0);
        small = o->piece_count <= FUZZ_ORACLE_PIECES;
    }
    if (small) {
        fuzz_choose_pieces(o, c, inside);
        fuzz_read_pieces(o, truth);
    }
    oracle_destroy(o);
    return small;
}

#endif /* GXFEM_TESTS_FUZZ_ORACLE_H */
