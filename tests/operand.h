/* operand.h - an operand of a Boolean from a surface's arrays. Include gxfem_boolean.h first. */
#ifndef TESTS_OPERAND_H
#define TESTS_OPERAND_H

#include <string.h>

static inline gxb_operand operand_from(const double *vertices, size_t vertex_count, const uint32_t *triangles,
                                       size_t triangle_count, uint32_t operation) {
    gxb_operand o;
    memset(&o, 0, sizeof o);
    o.vertices = vertices;
    o.vertex_count = vertex_count;
    o.triangles = triangles;
    o.triangle_count = triangle_count;
    o.operation = operation;
    return o;
}

#endif
