/* render/trace/parts/parts.h: rays against the moving parts, through Embree.
 *
 * One committed Embree scene for each node of each model, in the node's own axes, shared by every entity of that
 * model. A ray is transformed to the node in double, advanced to the node's bounding sphere and converted to float
 * once; Embree reports the triangle boxes that it passes; the triangle hit, distance and normals are computed in
 * double. So a moving joint costs a transform and no commit, nothing here changes between frames, and any number of
 * frames and threads may trace at once. */
#ifndef RENDER_TRACE_PARTS_PARTS_H
#define RENDER_TRACE_PARTS_PARTS_H

#include "entities/catalog/catalog.h"
#include "entities/models/model.h"

/* An Embree device and the scenes of the models, ready to be traced; lives across frames. */
typedef struct Tracer Tracer;

/* isa: NULL or "" leaves the choice to Embree; else "avx512", "avx2", "sse4.2" (passed as its isa setting). */
Status tracer_create(Tracer **out, const Catalog *catalog, const char *isa);
void   tracer_destroy(Tracer *tracer);

/* As tracer_create, with the models given directly; they must outlive the tracer. NULL among them: not drawable. Their
 * thin pieces (parts_node_thin), which only targets are asked for, are not listed. */
Status tracer_create_models(Tracer **out, const Model *const *models, int count, const char *isa);
int    tracer_model_count(const Tracer *tracer);
/* Version of the Embree that is loaded: 31305 is 3.13.5. */
int64_t tracer_embree(const Tracer *tracer);
/* Builds the geometry of a model of the catalog that was not built when the tracer was made. One thread, before
 * parts_pose. */
Status       tracer_need(Tracer *tracer, int model);
const Model *tracer_model(const Tracer *tracer, int model);

typedef struct NodeMesh NodeMesh;

/* A node that has triangles, in its present pose. */
typedef struct PosedNode {
    const NodeMesh *mesh;
    double          p_enu[3];
    double          r_enu_from_node[9];
    double          centre_enu[3]; /* of its sphere */
} PosedNode;

/* An entity in its present pose. Sphere and box hold all of its nodes as they are posed, independent of the model's
 * own sphere. */
typedef struct PosedEntity {
    int        damage;     /* 0 .. model_damage_states - 1 */
    int        model;      /* -1: not drawable (unknown model, or a pose that is not finite) */
    int        node_count; /* those with triangles */
    PosedNode *node;
    double     centre_enu[3], radius_m;
    double     p_enu[3], r_enu_from_body[9];
    double     box_low[3], box_high[3]; /* body axes */
} PosedEntity;

typedef struct PartHit {
    int      node;     /* of PosedEntity.node */
    uint32_t triangle; /* of the model */
} PartHit;

/* All vertices of a posed node, each once, in its axes; the outermost in some directions are the first block. */
enum { parts_block_corners = 32 };
const double (*parts_node_corners(const PosedNode *node, int *count))[3];

/* A box in a node's axes about a piece of it (triangles that share corners) that is a rod or a plate: one of the two
 * other sides is at most a twelfth of the first. */
typedef struct ThinBox {
    double centre[3], axis[3][3], half[3]; /* unit axes; half a side along each, m */
} ThinBox;
const ThinBox *parts_node_thin(const PosedNode *node, int *count);
/* The corners of a box that holds them, or those of a block alone (0: the first), in its axes. */
void parts_node_box(double corner[8][3], const PosedNode *node);
void parts_block_box(double corner[8][3], const PosedNode *node, int block);
/* The node of the largest sphere; of equals, the first. */
int parts_largest_node(const PosedEntity *entity);

/* Low and high corner of a box in its axes about its patch number k (a triangle, or neighbours with much the same box);
 * low above high: none of it has an area. False: k is out of range. */
bool parts_node_patch(double box[2][3], const PosedNode *node, int k);
/* The three corners of its triangle number k, in its axes. False: k is out of range. */
bool parts_node_triangle(double corner[3][3], const PosedNode *node, int k);

/* Number of nodes that posing an entity of this model needs memory for, at most. */
int parts_node_count(const Tracer *tracer, int model);
/* Radius of the largest of their spheres, m. */
double parts_largest_node_m(const Tracer *tracer, int model);
/* out->node must hold parts_node_count. pose: one for each node of the model, body axes. damage: parts that it hides
 * are omitted. */
void parts_pose(PosedEntity *out, const Tracer *tracer, int model, const NodePose *pose, const double p_enu[3],
                const double r_enu_from_body[9], int damage);

/* A box about an entity as it is posed, with its sphere's middle, along east, north and up. False: it is not drawable.
 */
bool parts_posed_box(double low[3], double high[3], const PosedEntity *entity);

/* Distance to the first triangle nearer than far_m, both sides count; INFINITY for none. ask_all: Embree is called
 * even where the entity's box or a node's sphere is missed, which must not change the result. */
double parts_first_hit(PartHit *hit, const PosedEntity *entity, const double o_enu[3], const double d_enu[3],
                       double far_m, bool ask_all);
/* Whether any triangle is ahead. */
bool parts_occluded(const PosedEntity *entity, const double o_enu[3], const double d_enu[3], bool ask_all);
/* The same for rays of a block, those of `list` (below hits_capacity), many at a time and to the same bits. Where
 * one is met nearer than far_m, range_m and hit are written, else they stay. range_m may be far_m. Returns the
 * number of ray-node pairs passed to Embree. */
uint64_t parts_first_hits(double *range_m, PartHit *hit, const PosedEntity *entity, const double *const o_enu[3],
                          const double *const d_enu[3], const double *far_m, const int *list, int count, bool ask_all);
/* met: becomes 1 where a triangle is met nearer than far_m; rays where it is 1 already are skipped. Returns as
 * above. */
uint64_t parts_any_hits(uint8_t *met, const PosedEntity *entity, const double *const o_enu[3],
                        const double *const d_enu[3], const double *far_m, const int *list, int count, bool ask_all);
/* A point on a triangle of the model, and a direction, in the axes of its node in the entity's present pose. */
void parts_on_part(double p_node[3], double n_node[3], const Model *model, const PosedEntity *entity, uint32_t triangle,
                   const double p_enu[3], const double n_enu[3]);

/* A triangle that was hit, in its present pose: for all hits on it. */
typedef struct PosedFacet {
    const PosedNode *node; /* NULL: none */
    uint32_t         triangle;
    bool             even;                                 /* one shading normal for all of it */
    double           corner[3], ab[3], ac[3], n[3], area2; /* node axes */
    double           geo_enu[3];                           /* unit; 0: a triangle without area */
    double           even_enu[3];                          /* unit */
} PosedFacet;

/* Fetches into the cache what parts_facet reads of a triangle of the model: first its indices, later what they lead to.
 */
static inline void parts_fetch(const Model *model, uint32_t triangle, bool first)
{
    const uint32_t *index = model->triangle[triangle];
    if (first) {
        __builtin_prefetch(index);
        __builtin_prefetch(&model->triangle_part[triangle]);
        return;
    }
    for (int c = 0; c < 3; c++) {
        __builtin_prefetch(model->vertex[index[c]]);
        __builtin_prefetch(model->normal[index[c]]);
    }
}
void parts_facet(PosedFacet *facet, const Model *model, const PosedEntity *entity, const PartHit *hit);
/* Unit normals at a distance along the ray, on the ray's side: of the triangle, and interpolated. */
void parts_facet_normals(double n_geo[3], double n_enu[3], const Model *model, const PosedFacet *facet,
                         const double o_enu[3], const double d_enu[3], double range_m);
void parts_normals(double n_geo[3], double n_enu[3], const Model *model, const PosedEntity *entity, const PartHit *hit,
                   const double o_enu[3], const double d_enu[3], double range_m);

#endif
