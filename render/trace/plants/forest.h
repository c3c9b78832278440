/* render/trace/plants/forest.h: rays against plants, through Embree.
 *
 * One committed scene for each prototype and level, and one scene of boxes over all standing plants (user geometry):
 * a ray that meets a plant's box is turned into the prototype's axes in double, converted to float once, and traced in
 * that scene; hit, range and normal are computed in double. Equal distances go to the plant of the lower index, and to
 * its lower quad. Low plants stand in squares about the eye, made on demand.
 *
 * Pages. The plants that Woods.plant leaves out stand in pages (woods_page), within far_m of the frame's eye, as seen
 * on the map: of all of them where nearer than forest_far_full far_m, and from there on each to a distance of its own,
 * drawn by its number, so that their share falls evenly to none at far_m. A page is placed, and its tree of boxes
 * built, when the first ray enters its box; other rays wait for it. Since what stands follows from the eye and far_m,
 * and a page from the woods, no order, thread or memory changes what rays meet. Pages that no open frame has used are
 * freed, the least recently used first, while all take more than far_mb. */
#ifndef RENDER_TRACE_PLANTS_FOREST_H
#define RENDER_TRACE_PLANTS_FOREST_H

#include "render/trace/plants/plants_kept.h"
#include "terrain/woods/woods.h"

typedef struct Forest Forest;

/* Height in the picture from which a standing plant is met itself where tables are used, least and most: each plant has
 * one of its own, so that a row of trees does not change all at once. */
static const double forest_table_px[2] = {84, 132};
static const double forest_table_rad = 0.25; /* and it is never met in a table where it is higher than that */

typedef struct ForestConfig {
    bool   leaves;    /* false: deciduous plants are bare */
    double level1_px; /* a standing plant lower than this in the picture is traced at plant_simple; 0: never */
    bool   fine;      /* others are traced at plant_fine above some height in the picture, of each plant its own between
                       * forest_fine_px; false: never */
    bool   all_fine;  /* with fine: at any height in the picture. Full detail, to measure errors by */
    double sway;      /* 0: plants stand still; 1: they sway by the wind of the frame */
    bool   tables;    /* rays from the frame's eye and to the sun meet standing plants that are lower in the picture
                       * than forest_table_px in tables (forest_table.c) */
    double far_m;     /* plants of pages (woods_page) stand within this of the eye; 0: none */
    double far_mb;    /* memory of pages that frames do not need any more is given back beyond this */
} ForestConfig;

/* Likewise from which it is traced at plant_fine. */
static const double forest_fine_px[2] = {24, 40};

/* woods and plants must outlive it. isa: as tracer_create. Memory: 146 octets or less a standing plant, Plant's own 20
 * included. */
Status forest_create(Forest **out, const Woods *woods, const Plants *plants, const ForestConfig *config,
                     const char *isa);
/* Other woods of the same prototypes, by the scenes of `of`, which must outlive it. */
Status forest_create_beside(Forest **out, const Forest *of, const Woods *woods);
void   forest_destroy(Forest *forest);
/* Fills in Plants.shade of the kinds that stand, at the finest level of the forest, by 1024 rays up and down for each
 * of its ways: within 5 % of the whole shadow (tests/render/test_canopy_shade.c).
 * pool: may be NULL; the same bits either way. */
void forest_shade(Plants *plants, const Forest *forest, Pool *pool);
/* Fills in PlantQuad.open_up and open_down of the forest's own prototypes, by rays through them: 24 a leaf, 8 a side of
 * a branch, so a leaf's are within 0.15 (rms), and their mean within 0.03 (tests/render/test_forest.c). Those of
 * patterned shapes are found when a ray first asks for them (ForestSurface): 2 a card and 2 a side; all cards of a
 * spray, and all sides of a piece of branch, have their mean. pool: may be NULL. STATUS_NO_MEMORY: some are as before.
 */
Status forest_openness(Plants *plants, const Forest *forest, Pool *pool);
/* From here on what rays find of the prototypes, texels of tables and the light of patterned shapes, is taken from
 * kept->cache when a ray first needs it, and written there when the forest is destroyed, and after a frame where much
 * of it is new; cache NULL: not. kept->name: of these prototypes; the cache outlives the forest. Before the first ray.
 */
void forest_keep(Forest *forest, const PlantsKept *kept);
/* Writes now what is new. Thread-safe. */
void          forest_keep_found(const Forest *forest);
const Woods  *forest_woods(const Forest *forest);
const Plants *forest_plants(const Forest *forest);
ForestConfig  forest_config(const Forest *forest);
/* Whether some plants are not always traced at the same level: level1_px > 0, fine, or tables. */
bool forest_simplifies(const Forest *forest);

/* A forest as one frame sees it; a pure function of these. */
typedef struct ForestFrame {
    const Forest *forest;
    double        eye_enu[3];  /* level of detail and low plants are by the distance from here */
    double        per_rad;     /* pixels a radian */
    double        ray_px;      /* width of what a ray stands for: 1, of several a pixel less; 0: no tables are used */
    int           columns;     /* of first hits: of a picture, in rows; 0: no order. A hint for speed alone */
    double        low_reach_m; /* low plants stand within this of the eye; 0: none */
    double        t_s;         /* exercise time, for sway */
    double        wind_mps[2]; /* east, north: towards which it blows */
    double bend_per_m; /* first hits are of rays from the eye that bend (terrain/earth/refraction.h); 0: straight */
    void  *low;        /* private: squares of low plants, of the arena */
    void  *far;        /* private: pages in reach */
} ForestFrame;

/* Low plants of the squares about the eye are made here, by pool (NULL: one thread). forest_frame_close before the
 * arena is reset; it accepts a frame of zeros. */
Status forest_frame_open(ForestFrame *out, const Forest *forest, const double eye_enu[3], double per_rad,
                         double low_reach_m, double t_s, const double wind_mps[2], Pool *pool, Arena *arena);
void   forest_frame_close(ForestFrame *frame);

/* Share of the plants of pages that stand at a place, 0 .. 1; of a place that no page has plants of: 0. */
double forest_far_share(const ForestFrame *frame, double x_m, double y_m);
/* The plants of a page, which stay while a frame is open that was opened before the call; they are made where they are
 * not there. STATUS_NO_MEMORY, logged: none. Thread-safe. */
Status forest_page_plants(const WoodsPage **out, const Forest *forest, int page);
/* Memory of all pages, octets, and how many were made. */
typedef struct ForestPagesUse {
    size_t   octets;
    uint64_t made, freed;
} ForestPagesUse;
ForestPagesUse      forest_pages_use(const Forest *forest);
static const double forest_far_full = 0.8;

enum { forest_low_bit = 1u << 31 };

typedef struct ForestHit {
    uint32_t plant;              /* index in Woods.plant, or woods_page_number; with forest_low_bit: a low plant, by a
                                  * number of its own. No two plants of a frame have the same */
    uint32_t place;              /* in its list */
    uint32_t quad;               /* of its shape */
    uint8_t  kind, level, organ; /* PlantKind, plant_fine .., PlantOrgan */
    bool     back;               /* met from the inner side of its surface (leaves: the card's back) */
    bool     by_table;
    float    uv[2]; /* on the quad */
} ForestHit;

/* For rays of a block: where some plant is nearer than range_m, range_m and hit are replaced. real: [count], 1: plants
 * are met themselves by this ray, at the finest level; NULL: 0. Returns rays that entered some plant's box.
 * Thread-safe. */
uint64_t forest_first_hits(double *range_m, ForestHit *hit, const ForestFrame *frame, int count,
                           const double *const o_enu[3], const double *const d_enu[3], const uint8_t *real);

/* What rays leave, [count] each. */
typedef struct ForestLeft {
    const uint8_t  *real;         /* as above */
    const uint32_t *plant, *quad; /* of hits on plants, ForestHit's; UINT32_MAX: none. NULL: no ray leaves a plant */
} ForestLeft;
/* dark becomes 1 where some plant is met nearer than far_m; rays where it is 1 already are left out. Tables are for
 * rays of the direction of the first. left: NULL: none leaves a plant, and none is real. */
uint64_t forest_any_hits(uint8_t *dark, const ForestFrame *frame, int count, const double *const o_enu[3],
                         const double *const d_enu[3], const double *far_m, const ForestLeft *left);

/* What shading needs of a hit. Normals are unit, ENU, on the ray's side; n_enu with the relief of bark. */
typedef struct ForestSurface {
    double  n_geo[3], n_enu[3];
    float   albedo;             /* reflectance over that of its material */
    float   height_share;       /* of the plant's height at which it lies, 0 .. 1 */
    float   radius_m;           /* of the branch; leaves: 0 */
    float   open_up, open_down; /* as PlantQuad */
    float   height_m;           /* of the plant */
    uint8_t mark;               /* PlantMark: what is painted there */
} ForestSurface;
void forest_surface(ForestSurface *out, const ForestFrame *frame, const ForestHit *hit, const double o_enu[3],
                    const double d_enu[3], double range_m, float footprint_m);

/* The same of many hits at once, to the same bits; footprints are range_m over frame->per_rad. Arrays of the caller's,
 * [count]. */
typedef struct ForestRays {
    const double *o_enu[3], *d_enu[3], *range_m;
} ForestRays;
typedef struct ForestSurfaces {
    double  *n_geo[3], *n_enu[3];
    float   *albedo, *radius_m, *open_up, *open_down;
    uint8_t *mark;
} ForestSurfaces;
void forest_surfaces(ForestSurfaces *out, const ForestFrame *frame, const ForestHit *const *hit, int count,
                     const ForestRays *rays);

#endif
