/* render/parts/parts_normals.c: normals of the triangle that a ray hit: of its plane and of the curved surface that
 * it approximates. */
#include "render/parts/parts.h"

void parts_facet(PosedFacet *facet, const Model *model, const PosedEntity *entity, const PartHit *hit)
{
    const PosedNode *node  = &entity->node[hit->node];
    const uint32_t  *index = model->triangle[hit->triangle];
    const float     *normal[3] = {model->normal[index[0]], model->normal[index[1]], model->normal[index[2]]};
    double           shading[3];
    facet->node     = node;
    facet->triangle = hit->triangle;
    v3_scale(facet->corner, 1, model->vertex[index[0]]);
    v3_sub(facet->ab, model->vertex[index[1]], facet->corner);
    v3_sub(facet->ac, model->vertex[index[2]], facet->corner);
    v3_cross(facet->n, facet->ab, facet->ac);
    facet->area2 = v3_dot(facet->n, facet->n);
    m3_mul_v3(facet->geo_enu, node->r_enu_from_node, facet->n);
    if (!v3_normalize(facet->geo_enu, facet->geo_enu)) memset(facet->geo_enu, 0, sizeof facet->geo_enu);
    for (int c = 0; c < 3; c++) shading[c] = normal[0][c];
    m3_mul_v3(facet->even_enu, node->r_enu_from_node, shading);
    facet->even = v3_normalize(facet->even_enu, facet->even_enu);
    for (int c = 0; c < 3; c++) facet->even &= normal[0][c] == normal[1][c] && normal[0][c] == normal[2][c];
}

/* Shading normal at a point of the facet. False: none. */
static bool interpolate(double n_enu[3], const Model *model, const PosedFacet *facet, const double o_enu[3],
                        const double d_enu[3], double range_m)
{
    const PosedNode *node  = facet->node;
    const uint32_t  *index = model->triangle[facet->triangle];
    double           at_enu[3], at[3], w[3], cross[3], shading[3] = {0, 0, 0};
    /* barycentric weights of the point on the plane; just outside the triangle they are clamped to it */
    for (int c = 0; c < 3; c++) at_enu[c] = o_enu[c] + range_m * d_enu[c] - node->p_enu[c];
    m3_tmul_v3(at, node->r_enu_from_node, at_enu);
    v3_sub(at, at, facet->corner);
    v3_cross(cross, at, facet->ac);
    w[1] = clamp(v3_dot(cross, facet->n) / facet->area2, 0, 1);
    v3_cross(cross, facet->ab, at);
    w[2] = clamp(v3_dot(cross, facet->n) / facet->area2, 0, 1);
    w[0] = 1 - w[1] - w[2] < 0 ? 0 : 1 - w[1] - w[2];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) shading[c] += w[k] * model->normal[index[k]][c];
    m3_mul_v3(n_enu, node->r_enu_from_node, shading);
    return v3_normalize(n_enu, n_enu);
}

void parts_facet_normals(double n_geo[3], double n_enu[3], const Model *model, const PosedFacet *facet,
                         const double o_enu[3], const double d_enu[3], double range_m)
{
    const bool some = facet->geo_enu[0] != 0 || facet->geo_enu[1] != 0 || facet->geo_enu[2] != 0;
    v3_scale(n_geo, some ? 1 : -1, some ? facet->geo_enu : d_enu);
    if (facet->even) v3_scale(n_enu, 1, facet->even_enu);
    else if (!interpolate(n_enu, model, facet, o_enu, d_enu, range_m)) v3_scale(n_enu, 1, n_geo);
    if (v3_dot(n_geo, d_enu) > 0) {
        v3_scale(n_geo, -1, n_geo);
        v3_scale(n_enu, -1, n_enu);
    }
}

void parts_normals(double n_geo[3], double n_enu[3], const Model *model, const PosedEntity *entity, const PartHit *hit,
                   const double o_enu[3], const double d_enu[3], double range_m)
{
    PosedFacet facet;
    parts_facet(&facet, model, entity, hit);
    parts_facet_normals(n_geo, n_enu, model, &facet, o_enu, d_enu, range_m);
}
