/* skin_check.h - is the skin a closed surface? Vertices are merged by gx_skin's rule: same material point and same
   copies of weight not 0. Include after gxfem.h. */
#ifndef SKIN_CHECK_H
#define SKIN_CHECK_H
#include <stdlib.h>
#include <string.h>

typedef struct skin_corner {
    uint32_t point, copies[4], vertex;
} skin_corner;
typedef struct skin_edge {
    uint32_t low, high;
    int way;
} skin_edge;
typedef struct skin_counts {
    long vertices, edges, triangles;
    long open_edges; /* edges with more triangles one way than the other */
    double volume;   /* inside, at rest */
} skin_counts;

static int skin_compare_words(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

static int skin_compare_corners(const void *a, const void *b) {
    return memcmp(a, b, sizeof(skin_corner) - sizeof(uint32_t));
}

static int skin_compare_edges(const void *a, const void *b) {
    const skin_edge *p = (const skin_edge *)a, *q = (const skin_edge *)b;
    return p->low != q->low ? (p->low < q->low ? -1 : 1) : p->high != q->high ? (p->high < q->high ? -1 : 1) : 0;
}

/* merged[v]: number of the corner to which vertex v belongs. Returns the number of corners. */
static uint32_t skin_merge(const gx_skin *skin, uint32_t *merged) {
    skin_corner *corners = (skin_corner *)calloc(skin->vertex_count + 1, sizeof *corners);
    uint32_t count = 0;
    size_t v;
    int k;
    for (v = 0; v < skin->vertex_count; v++) {
        corners[v].point = skin->vertex_point[v];
        corners[v].vertex = (uint32_t)v;
        for (k = 0; k < 4; k++)
            corners[v].copies[k] =
                skin->vertex_weights[4 * v + (size_t)k] != 0 ? skin->vertex_copies[4 * v + (size_t)k] : UINT32_MAX;
        qsort(corners[v].copies, 4, sizeof(uint32_t), skin_compare_words);
    }
    qsort(corners, skin->vertex_count, sizeof *corners, skin_compare_corners);
    for (v = 0; v < skin->vertex_count; v++) {
        if (v == 0 || skin_compare_corners(&corners[v], &corners[v - 1]) != 0) count++;
        merged[corners[v].vertex] = count - 1;
    }
    free(corners);
    return count;
}

static double skin_cone(const double *a, const double *b, const double *c) {
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
            a[2] * (b[0] * c[1] - b[1] * c[0])) /
           6;
}

/* Counts over the triangles of one fragment, or of all (fragment UINT32_MAX). positions: by gx_body_skin_positions. */
static skin_counts skin_count(const gx_skin *skin, uint32_t fragment, const double *positions) {
    uint32_t *merged = (uint32_t *)malloc((skin->vertex_count + 1) * sizeof *merged);
    const uint32_t corners = skin_merge(skin, merged);
    uint8_t *used = (uint8_t *)calloc(corners + 1, 1);
    skin_edge *edges = (skin_edge *)malloc((3 * skin->triangle_count + 1) * sizeof *edges);
    skin_counts n = {0, 0, 0, 0, 0};
    size_t t, i, j, edge_count = 0;
    for (t = 0; t < skin->triangle_count; t++) {
        const uint32_t *v = skin->triangles + 3 * t;
        if (fragment != UINT32_MAX && skin->triangle_fragment[t] != fragment) continue;
        n.triangles++;
        n.volume += skin_cone(positions + 3 * (size_t)v[0], positions + 3 * (size_t)v[1], positions + 3 * (size_t)v[2]);
        for (i = 0; i < 3; i++) {
            const uint32_t a = merged[v[i]], b = merged[v[(i + 1) % 3]];
            used[a] = 1;
            edges[edge_count].low = a < b ? a : b;
            edges[edge_count].high = a < b ? b : a;
            edges[edge_count++].way = a < b ? 1 : -1;
        }
    }
    for (i = 0; i < corners; i++) n.vertices += used[i];
    qsort(edges, edge_count, sizeof *edges, skin_compare_edges);
    for (i = 0; i < edge_count; i = j) {
        int balance = 0;
        for (j = i; j < edge_count && skin_compare_edges(&edges[i], &edges[j]) == 0; j++) balance += edges[j].way;
        n.edges++;
        n.open_edges += balance != 0;
    }
    free(merged);
    free(used);
    free(edges);
    return n;
}
#endif
