/* boolean_oracle.h - the true Boolean of a few small surfaces, by oracle.h: space, as one large tetrahedron, divided
   by all planes. Exact winding numbers tell whether a piece is inside. Components are pieces joined across faces in
   which no sheet lies. The Euler characteristic is that of the faces between inside and outside (or at a sheet),
   joined around edges through the inside. */
#ifndef GXFEM_TESTS_BOOLEAN_ORACLE_H
#define GXFEM_TESTS_BOOLEAN_ORACLE_H

#include "oracle.h"

enum { TRUTH_OPERANDS = 16, TRUTH_PARTS = 900 };

typedef struct truth_question {
    const oracle_surface *surface; /* count; surfaces that are no solids divide, and do not wind */
    const size_t *vertex_count;    /* count */
    size_t count, planes, pieces;  /* count; limits of planes and pieces */
    int (*inside)(void *user, const int32_t *winding, size_t count);
    void *user;
} truth_question;

typedef struct truth {
    size_t components;
    long euler;
    double volume, part[TRUTH_PARTS]; /* part: of the components, up to this number */
} truth;

/* ---- faces of pieces ---- */

typedef struct truth_face {
    size_t piece, neighbour;      /* SIZE_MAX: there is none */
    size_t corners, corner_count; /* into truth_faces.corner: points */
    int plane, open;              /* open: the inside continues behind it */
} truth_face;

typedef struct truth_faces {
    const oracle *o;
    truth_face *face;
    size_t count;
    size_t *corner;
    size_t corner_count;
    size_t *of; /* piece x plane: face, SIZE_MAX: none */
} truth_faces;

static inline size_t truth_face_at(const truth_faces *f, size_t piece, int plane) {
    return f->of[piece * f->o->plane_count + (size_t)plane];
}

static inline void truth_add_face(truth_faces *f, size_t piece, int plane) {
    const oracle_piece *p = &f->o->pieces[piece];
    truth_face *face;
    size_t i, on = 0;
    for (i = 0; i < p->point_count; i++) on += (size_t)oracle_set_has(&oracle_corner(f->o, p, i)->zero, plane);
    if (on < 3) return;
    f->face = (truth_face *)oracle_grow(f->face, f->count, sizeof *f->face);
    face = &f->face[f->count];
    face->piece = piece;
    face->plane = plane;
    face->neighbour = SIZE_MAX;
    face->open = 0;
    face->corners = f->corner_count;
    face->corner_count = on;
    for (i = 0; i < p->point_count; i++) {
        if (!oracle_set_has(&oracle_corner(f->o, p, i)->zero, plane)) continue;
        f->corner = (size_t *)oracle_grow(f->corner, f->corner_count, sizeof *f->corner);
        f->corner[f->corner_count++] = f->o->corners[p->points + i];
    }
    f->of[piece * f->o->plane_count + (size_t)plane] = f->count++;
}

static inline void truth_join_faces(truth_faces *f) {
    size_t i, j;
    for (i = 0; i < f->o->piece_count; i++)
        for (j = 0; j < f->o->piece_count; j++) {
            const int k = oracle_set_difference(&f->o->pieces[i].plus, &f->o->pieces[j].plus);
            size_t face;
            rat_mark mark = rat_arena_mark();
            oracle_set on = oracle_set_empty();
            oracle_contact c;
            if (i == j || k == ORACLE_NONE || f->o->pieces[i].removed || f->o->pieces[j].removed) continue;
            face = truth_face_at(f, i, k);
            oracle_set_add(&on, k);
            c = oracle_contact_of(f->o, &f->o->pieces[i], &on);
            f->face[face].neighbour = j;
            f->face[face].open = !oracle_covered(f->o, &c, 0);
            rat_arena_release(mark);
        }
}

static inline truth_faces truth_find_faces(const oracle *o) {
    truth_faces f;
    size_t i;
    int k;
    memset(&f, 0, sizeof f);
    f.o = o;
    f.of = (size_t *)oracle_memory(NULL, o->piece_count * o->plane_count, sizeof *f.of);
    for (i = 0; i < o->piece_count * o->plane_count; i++) f.of[i] = SIZE_MAX;
    for (i = 0; i < o->piece_count; i++)
        for (k = 0; k < (int)o->plane_count && !o->pieces[i].removed; k++) truth_add_face(&f, i, k);
    truth_join_faces(&f);
    return f;
}

/* The other face of its piece around the edge between two points */
static inline size_t truth_turn(const truth_faces *f, size_t face, size_t a, size_t b) {
    const size_t piece = f->face[face].piece;
    int k;
    for (k = 0; k < (int)f->o->plane_count; k++) {
        const size_t other = truth_face_at(f, piece, k);
        if (other != SIZE_MAX && other != face && oracle_set_has(&f->o->points[a].zero, k) &&
            oracle_set_has(&f->o->points[b].zero, k))
            return other;
    }
    rat_stop("oracle: an edge of one face");
    return 0;
}

static inline size_t truth_corner_of(const truth_faces *f, size_t face, size_t point) {
    size_t i = f->face[face].corners;
    while (f->corner[i] != point) i++;
    return i;
}

/* Vertices - edges + faces of the boundary: corners of faces that meet around a vertex are one vertex. */
static inline long truth_euler(const oracle *o) {
    truth_faces f = truth_find_faces(o);
    size_t *parent = oracle_singles(f.corner_count), i, a, b, sides = 0;
    oracle_set done = oracle_done(o->plane_count);
    long euler = 0;
    for (i = 0; i < f.count; i++) {
        const oracle_piece *p = &o->pieces[f.face[i].piece];
        if (f.face[i].open) continue;
        euler++;
        for (a = 0; a < p->point_count; a++)
            for (b = a + 1; b < p->point_count; b++) {
                const size_t x = o->corners[p->points + a], y = o->corners[p->points + b];
                size_t mate;
                if (!oracle_set_has(&o->points[x].zero, f.face[i].plane) ||
                    !oracle_set_has(&o->points[y].zero, f.face[i].plane))
                    continue;
                if (!oracle_adjacent(o, p, a, b, &done)) continue;
                sides++;
                mate = truth_turn(&f, i, x, y);
                while (f.face[mate].open)
                    mate = truth_turn(&f, truth_face_at(&f, f.face[mate].neighbour, f.face[mate].plane), x, y);
                oracle_join(parent, truth_corner_of(&f, i, x), truth_corner_of(&f, mate, x));
                oracle_join(parent, truth_corner_of(&f, i, y), truth_corner_of(&f, mate, y));
            }
    }
    for (i = 0; i < f.count; i++)
        for (a = f.face[i].corners; a < f.face[i].corners + f.face[i].corner_count; a++)
            euler += !f.face[i].open && oracle_root(parent, a) == a;
    free(f.face);
    free(f.corner);
    free(f.of);
    free(parent);
    return euler - (long)(sides / 2);
}

/* ---- the whole ---- */

/* A tetrahedron around all operands */
static inline void truth_frame(const truth_question *q, double x[4][3]) {
    double size = 0;
    size_t i, j;
    int k, e;
    for (i = 0; i < q->count; i++)
        for (j = 0; j < 3 * q->vertex_count[i]; j++) size = fmax(size, fabs(q->surface[i].vertices[j]));
    frexp(size, &e);
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) x[i][k] = ldexp((int)i == k + 1 ? 4 : -1, e + 1);
}

static inline void truth_choose_pieces(oracle *o, const truth_question *q) {
    size_t *region = oracle_singles(o->piece_count), i, s;
    oracle_join_inside(o, region, 1);
    for (i = 0; i < o->piece_count; i++) {
        int32_t winding[TRUTH_OPERANDS];
        rat_mark mark = rat_arena_mark();
        oracle_set nothing = oracle_set_empty();
        oracle_contact middle;
        o->pieces[i].region = oracle_root(region, i);
        if (o->pieces[i].region != i) {
            o->pieces[i].removed = o->pieces[o->pieces[i].region].removed;
            continue;
        }
        middle = oracle_contact_of(o, &o->pieces[i], &nothing);
        for (s = 0; s < q->count; s++) winding[s] = q->surface[s].solid ? oracle_winding(o, s, middle.center) : 0;
        o->pieces[i].removed = !q->inside(q->user, winding, q->count);
        rat_arena_release(mark);
    }
    free(region);
}

static inline void truth_read_pieces(oracle *o, truth *t) {
    size_t *component = oracle_singles(o->piece_count), *name = oracle_singles(o->piece_count), i;
    memset(t, 0, sizeof *t);
    oracle_join_inside(o, component, 0);
    for (i = 0; i < o->piece_count; i++) {
        const size_t root = oracle_root(component, i);
        double volume;
        if (o->pieces[i].removed) continue;
        if (root == i) name[i] = t->components++;
        volume = oracle_piece_volume(o, &o->pieces[i]);
        if (name[root] < TRUTH_PARTS) t->part[name[root]] += volume;
        t->volume += volume;
    }
    t->euler = truth_euler(o);
    free(component);
    free(name);
}

/* 0: too large for it */
static inline int truth_ask(const truth_question *q, truth *t) {
    static const uint32_t nodes[4] = {0, 1, 2, 3};
    double frame[4][3];
    oracle *o = (oracle *)oracle_memory(NULL, 1, sizeof *o);
    int small;
    memset(o, 0, sizeof *o);
    o->mark = rat_arena_mark();
    truth_frame(q, frame);
    o->mesh.positions = &frame[0][0];
    o->mesh.node_count = 4;
    o->mesh.elements = nodes;
    o->mesh.element_count = 1;
    oracle_find_planes(o, q->surface, q->count);
    small = o->plane_count <= q->planes;
    if (small) {
        o->element_pieces = (size_t *)oracle_memory(NULL, 2, sizeof *o->element_pieces);
        o->element_pieces[0] = 0;
        oracle_divide_element(o, 0);
        small = o->piece_count <= q->pieces;
    }
    if (small) {
        truth_choose_pieces(o, q);
        truth_read_pieces(o, t);
    }
    oracle_destroy(o);
    return small;
}

#endif /* GXFEM_TESTS_BOOLEAN_ORACLE_H */
