/* render/frame/edges.c: selects the pixels that need more samples than one.
 *
 * A pixel is sampled again where it and a neighbour (left, right, above, below) show different entities, parts or
 * materials, surfaces at an angle to each other, one shadowed and one lit, or a step in depth that neither's own
 * plane explains. Between two ground classes no further ray is needed: the existing hit gives the plane of the
 * ground. Parts that fall between the samples (a barrel, a mast) lie within the bounding box of their target: pixels
 * in the boxes of targets that are too large for a target grid and small enough to have such parts are always
 * sampled again, and so are thin pieces of larger targets and the ground where a small target's shadow falls. Plants
 * are no edges among themselves or against the ground behind them, or every pixel of a wood would be one: they are
 * filtered (leaf_filter.c). Within a few pixels of a target they are refined. So is scenery where pixels are wide:
 * there its borders are as many as leaves. */

#include "render/frame/frame_private.h"
#include "render/trace/parts/parts.h"

/* Up to this size on the image, along its longer side, some part of a vehicle may be narrower than a pixel: a gun
 * barrel is a sixtieth of its tank's length. */
static const double middling_px = 64;
static const double about_px = 3; /* plants so near a target's box hide parts of it: they are refined */
static const double thin_px = 6;  /* a shadow of more rows than this is met by samples, and its edges are found */
static const double sharp_cosine = 0.866; /* 30 degrees: a seventh of the light, with the sun at 45 degrees */
static const double step_part = 0.05, step_ground = 0.5; /* of the range */
/* Wider pixels show houses as a texture: like plants', its borders, and those of shadows amid it, are no edges but
 * within a few pixels of a target. Their error: `bench precision`, "borders of scenery". */
static const double scenery_px_m = 0.25;
static const double kinds_bent = 1; /* of the change of range from pixel to pixel: real ground is not planar */

static void mark_box(Job *job, const double box[4], RefineFlag flag)
{
    const View *view = &job->request->view;
    const int   x0 = (int)fmax(0, floor(box[0])), x1 = (int)fmin(view->width, ceil(box[2]));
    const int   y0 = (int)fmax(0, floor(box[1])), y1 = (int)fmin(view->height, ceil(box[3]));
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) job->refine[pixel_index(job, x, y)] |= (uint8_t)flag;
}

/* Conservative bounding box of a sphere's image; false: not in front of the eye. */
static bool sphere_box(double box[4], const View *view, const double centre_enu[3], double radius_m)
{
    double offset_enu[3], p_cam[3];
    v3_sub(offset_enu, centre_enu, view->p_enu);
    m3_tmul_v3(p_cam, view->r_enu_from_cam, offset_enu);
    if (!(p_cam[2] > 2 * radius_m)) return false;
    double at_px[2], half_px = view->focal_px * radius_m / (p_cam[2] - radius_m);
    view_project(at_px, view, p_cam);
    if (view_has_lens(view)) half_px *= 1.5; /* more than an accepted lens adds */
    for (int k = 0; k < 2; k++) box[k] = at_px[k] - half_px, box[k + 2] = at_px[k] + half_px;
    return true;
}

/* The box on the image from the target's foot to where the shadow of its top falls on level ground. */
static bool shadow_box(double box[4], const Job *job, int index)
{
    const SnapshotEntity *entity = &job->scene.snapshot->entity[index];
    const double         *sun = job->scene.air->light.sun_d_enu;
    double                foot_enu[3], tip_enu[3], foot[4], tip[4];
    if (entity->model < 0) return false;
    const Model *model = catalog_model(job->scene.world->catalog, entity->model);
    if (!job->scene.world->landscape || !(sun[2] > 0.05)) return false; /* below 3 degrees: a faint streak */
    enu_from_ecef(foot_enu, &job->scene.world->frame, entity->p_ecef);
    /* the shadow of an aircraft is elsewhere, and fainter with distance */
    const double above_m =
        foot_enu[2] - elevation_height(&job->scene.world->landscape->elevation, foot_enu[0], foot_enu[1], NULL);
    if (!(fabs(above_m) < model->height_m)) return false;
    foot_enu[2] += visibility_lift(job->scene.visibility, index);
    v3_add_scaled(tip_enu, foot_enu, -model->height_m / sun[2], sun);
    tip_enu[2] = foot_enu[2];
    if (!sphere_box(foot, &job->request->view, foot_enu, 0.5 * model->radius_m) ||
        !sphere_box(tip, &job->request->view, tip_enu, 0.5 * model->radius_m))
        return false;
    for (int k = 0; k < 2; k++) {
        box[k] = fmin(foot[k], tip[k]);
        box[k + 2] = fmax(foot[k + 2], tip[k + 2]);
    }
    return fmin(box[2] - box[0], box[3] - box[1]) <= thin_px && fmax(box[2] - box[0], box[3] - box[1]) <= middling_px;
}

/* ---- antennas, wires and edge-on plates on the image, by boxes about them -------------------- */

/* Pieces narrower than a pixel have boxes narrower than this: about a square bar the box may stand on its edge. */
static const double thin_box_px = 2;

/* Where a box lies on the image: the ends of the axis that is longest there, and its width across it, px. */
typedef struct ThinLine {
    double end_px[2][2], width_px;
} ThinLine;

/* False: not all of it is in front of the eye, or it is a point. */
static bool line_of_box(ThinLine *out, const View *view, const PosedNode *node, double lift_m, const ThinBox *box)
{
    double along_px[3][2], end_px[3][2][2], longest_px = 0;
    int    longest = 0;
    for (int a = 0; a < 3; a++) {
        for (int s = 0; s < 2; s++) {
            double p_node[3], p_enu[3], p_cam[3];
            v3_add_scaled(p_node, box->centre, s ? box->half[a] : -box->half[a], box->axis[a]);
            m3_mul_v3(p_enu, node->r_enu_from_node, p_node);
            v3_add(p_enu, p_enu, node->p_enu);
            v3_sub(p_enu, p_enu, view->p_enu);
            p_enu[2] += lift_m;
            m3_tmul_v3(p_cam, view->r_enu_from_cam, p_enu);
            if (!(p_cam[2] > 0)) return false;
            view_project(end_px[a][s], view, p_cam);
        }
        for (int k = 0; k < 2; k++) along_px[a][k] = end_px[a][1][k] - end_px[a][0][k];
        const double length_px = sqrt(along_px[a][0] * along_px[a][0] + along_px[a][1] * along_px[a][1]);
        if (length_px > longest_px) longest_px = length_px, longest = a;
    }
    if (!(longest_px > 0 && longest_px < 1e6)) return false;
    memcpy(out->end_px, end_px[longest], sizeof out->end_px);
    out->width_px = 0;
    for (int a = 0; a < 3; a++)
        out->width_px +=
            fabs(along_px[a][0] * along_px[longest][1] - along_px[a][1] * along_px[longest][0]) / longest_px;
    return true;
}

/* Marks the pixels that come within half the line's width of it. */
static void mark_line(Job *job, const ThinLine *line, uint8_t flag)
{
    const View  *view = &job->request->view;
    const double dx = line->end_px[1][0] - line->end_px[0][0], dy = line->end_px[1][1] - line->end_px[0][1];
    const int    axis = fabs(dx) >= fabs(dy) ? 0 : 1; /* along which its pixels are counted */
    const int    size[2] = {view->width, view->height};
    const double slope = axis ? dx / dy : dy / dx, half_px = 0.5 * line->width_px;
    const double low = fmin(line->end_px[0][axis], line->end_px[1][axis]) - half_px;
    const double high = fmax(line->end_px[0][axis], line->end_px[1][axis]) + half_px;
    /* along the other axis, over all of a pixel's length */
    const double reach = half_px * sqrt(1 + slope * slope) + 0.5 * fabs(slope);
    for (int k = (int)clamp(floor(low), 0, size[axis]); k < (int)clamp(ceil(high), 0, size[axis]); k++) {
        const double on = line->end_px[0][!axis] + (k + 0.5 - line->end_px[0][axis]) * slope;
        const int    from = (int)clamp(floor(on - reach), 0, size[!axis]),
                  to = (int)clamp(ceil(on + reach), 0, size[!axis]);
        for (int l = from; l < to; l++) job->refine[axis ? pixel_index(job, l, k) : pixel_index(job, k, l)] |= flag;
    }
}

/* Sets a flag of Job.refine at the pixels on thin pieces of an entity that lies in front of the eye: some of their
 * rays meet such a piece and others do not, and one ray a pixel shows it as dashes. */
static void mark_thin_lines(Job *job, int index, uint8_t flag)
{
    const PosedEntity *entity = visibility_posed(job->scene.visibility, index);
    const double       lift_m = visibility_lift(job->scene.visibility, index);
    for (int n = 0; entity->model >= 0 && n < entity->node_count; n++) {
        int            count;
        const ThinBox *box = parts_node_thin(&entity->node[n], &count);
        for (int k = 0; k < count; k++) {
            ThinLine line;
            if (!line_of_box(&line, &job->request->view, &entity->node[n], lift_m, &box[k])) continue;
            if (line.width_px < thin_box_px) mark_line(job, &line, flag);
        }
    }
}

/* ---- what is always refined ------------------------------------------------------------------ */

void mark_boxes(Job *job)
{
    const bool shadows = has_band(job->request->bands, BAND_OPTICAL) || has_band(job->request->bands, BAND_MWIR);
    for (int i = 0; i < job->scene.snapshot->count; i++) {
        const TargetPixels *t = &job->boxes[i];
        double              shadow[4];
        if (!t->projected) continue;
        const double *box = t->projected_box;
        const double  about[4] = {box[0] - about_px, box[1] - about_px, box[2] + about_px, box[3] + about_px};
        if (i != job->request->hidden_entity && !target_grid_hidden(job, i)) mark_box(job, about, refine_leaves);
        if (!(fmax(box[2] - box[0], box[3] - box[1]) <= middling_px)) {
            mark_thin_lines(job, i, refine_all);
            continue;
        }
        if (!job->is_small[i]) mark_box(job, box, refine_all);
        if (shadows && shadow_box(shadow, job, i)) mark_box(job, shadow, refine_sun);
    }
}

/* ---- neighbours ------------------------------------------------------------------------------- */

/* Two pixels: their places in the planes, and on the picture. */
typedef struct PixelPair {
    size_t a, b;
    int    xa, ya, xb, yb;
} PixelPair;

/* Range at which a ray meets the plane of another pixel's hit; the eye is the origin. NaN: never. */
static double plane_range(const Picture *p, size_t at, const double d_at[3], const double d[3])
{
    const double n[3] = {p->normal[0][at], p->normal[1][at], p->normal[2][at]};
    const double range_m = p->range_m[at] * v3_dot(n, d_at) / v3_dot(n, d);
    return range_m > 0 && range_m < INFINITY ? range_m : NAN;
}

/* Whether hit b is off the plane of hit a: by more than step_m plus `bent` times the change of range along it. */
static bool lies_off(const Picture *p, size_t a, size_t b, const double d_a[3], const double d_b[3], double step_m,
                     double bent)
{
    const double there_m = plane_range(p, a, d_a, d_b);
    return !(fabs(there_m - p->range_m[b]) <= step_m + bent * fabs(there_m - p->range_m[a]));
}

/* Whether each of two hits is off the other's plane; `either`: one is enough (a roof and the wall below it, one of
 * them seen edge-on). */
static bool steps_in_depth(const Job *job, const PixelPair *pair, double step_m, double bent, bool either)
{
    const Picture *p = job->picture;
    const size_t   a = pair->a, b = pair->b;
    double         d_a[3], d_b[3];
    if (fabsf(p->range_m[a] - p->range_m[b]) <= step_m) return false;
    view_ray(d_a, &job->request->view, pair->xa + 0.5, pair->ya + 0.5);
    view_ray(d_b, &job->request->view, pair->xb + 0.5, pair->yb + 0.5);
    const bool from_a = lies_off(p, a, b, d_a, d_b, step_m, bent), from_b = lies_off(p, b, a, d_b, d_a, step_m, bent);
    return either ? from_a || from_b : from_a && from_b;
}

/* Whether a pixel of this width, not near a target, shows scenery as a texture. */
static bool is_texture(const Job *job, size_t px, double px_m)
{
    const double widest_m = job->request->scenery_px_m > 0 ? job->request->scenery_px_m : scenery_px_m;
    return px_m > widest_m && !(job->refine[px] & refine_leaves);
}

/* The edge of a shadow. Amid scenery most are those of houses, and cost as much as its borders. */
static unsigned shadow_edge(const Job *job, size_t px, double px_m)
{
    const bool near = job->refine[px] & refine_leaves;
    if (!job->scene.world->scenery || near || job->request->samples > 1) return refine_sun;
    return is_texture(job, px, px_m) ? 0 : refine_shade;
}

/* leaves: plants are edges. */
static unsigned edge_between(const Job *job, int xa, int ya, int xb, int yb, bool leaves)
{
    const Picture *p = job->picture;
    const size_t   a = pixel_index(job, xa, ya), b = pixel_index(job, xb, yb);
    const bool     part = p->part[a] || p->part[b], plants = !part && p->instance && (p->instance[a] || p->instance[b]);
    const bool     entity = p->entity[a] || p->entity[b];
    const double   near_m = fmin(p->range_m[a], p->range_m[b]), px_m = near_m / job->request->view.focal_px;
    const unsigned edge = entity ? refine_all
                          : part ? refine_scenery
                                 : refine_step; /* scenery is what targets stand before */
    const bool     sky_a = !(p->range_m[a] < INFINITY), sky_b = !(p->range_m[b] < INFINITY);
    if (sky_a && sky_b) return 0;
    if (part && !entity && !sky_a && !sky_b && is_texture(job, a, px_m)) return 0;
    if (p->entity[a] != p->entity[b] || p->part[a] != p->part[b]) return edge;
    if (part && p->instance && p->instance[a] != p->instance[b]) return edge;
    if (sky_a != sky_b) return refine_step;
    if (plants) return leaves ? refine_plants : 0; /* most neighbours differ in light or kind */
    const bool   other = p->material[a] != p->material[b];
    const double cosine =
        p->normal[0][a] * p->normal[0][b] + p->normal[1][a] * p->normal[1][b] + p->normal[2][a] * p->normal[2][b];
    const bool      kinds = other && !part; /* a crest between two ground classes is worth refining when it is low */
    const double    step_m = part ? step_part * near_m : kinds ? px_m : step_ground * near_m;
    const PixelPair pair = {a, b, xa, ya, xb, yb};
    if (!(cosine > sharp_cosine) || steps_in_depth(job, &pair, step_m, kinds ? kinds_bent : 0, kinds)) return edge;
    if (part && other) return edge;
    const bool shade = (job->sun[a] > 0) != (job->sun[b] > 0);
    return (other ? refine_ground : 0) | (!shade ? 0 : entity ? refine_sun : shadow_edge(job, a, px_m));
}

/* What a pair of neighbours is, in find_pairs: it may be an edge; they are clearly alike; some plant is in it, and it
 * is none unless plants are (edge_between). */
enum { pair_may_differ, pair_alike, pair_of_plants };

/* Pairs of `count` pixels from a on and those from b on: in arrays, as most need no closer look. */
static void find_pairs(uint32_t *restrict pair, const Job *job, size_t a, size_t b, int count)
{
    const Picture  *p = job->picture;
    const float    *nx = p->normal[0], *ny = p->normal[1], *nz = p->normal[2], *range_m = p->range_m;
    const uint32_t *entity = p->entity, *part = p->part, *material = p->material;
    const uint32_t *plant = p->instance ? p->instance : p->part; /* none: a plane that is compared anyway */
    const uint32_t  plants = p->instance != NULL;
    const float     cosine = (float)sharp_cosine * 1.0001f, step = (float)step_part * 0.999f;
    for (int i = 0; i < count; i++) {
        const size_t   k = a + (size_t)i, l = b + (size_t)i;
        const uint32_t other = (entity[k] ^ entity[l]) | (part[k] ^ part[l]);
        const uint32_t else_other =
            (material[k] ^ material[l]) | (plant[k] ^ plant[l]) | (uint32_t)((job->sun[k] > 0) != (job->sun[l] > 0));
        const float    turn = nx[k] * nx[l] + ny[k] * ny[l] + nz[k] * nz[l];
        const float    near_m = range_m[k] < range_m[l] ? range_m[k] : range_m[l];
        const float    far_m = range_m[k] < range_m[l] ? range_m[l] : range_m[k];
        const uint32_t plain = (uint32_t)((other | else_other) == 0) & (uint32_t)(turn > cosine) &
                               (uint32_t)(far_m - near_m <= step * near_m);
        const uint32_t sky = (uint32_t) !(near_m < INFINITY);
        const uint32_t leaves = plants & (uint32_t)(other == 0) & (uint32_t)(far_m < INFINITY) &
                                (uint32_t)((plant[k] | plant[l]) != 0) & (uint32_t)(part[k] == 0);
        pair[i] = plain | sky ? pair_alike : leaves ? pair_of_plants : pair_may_differ;
    }
}

/* The four pairs of a pixel: left, right, above, below. */
typedef struct PixelPairs {
    uint32_t pair[4];
} PixelPairs;

/* Flags of a pixel at x, y by its neighbours, those marked included. leafy: it or some neighbour shows a plant. */
static unsigned flags_of_pairs(bool *leafy, const Job *job, int x, int y, const PixelPairs *of)
{
    static const int beside[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    const View      *view = &job->request->view;
    const size_t     px = pixel_index(job, x, y);
    unsigned         flag = job->refine[px];
    const bool       leaves = flag & refine_leaves;
    *leafy = picture_shows_plant(job->picture, px);
    const uint32_t *pair = of->pair;
    if (pair[0] == pair_alike && pair[1] == pair_alike && pair[2] == pair_alike && pair[3] == pair_alike) return flag;
    for (int n = 0; n < 4 && !(flag & refine_all); n++) {
        const int xb = x + beside[n][0], yb = y + beside[n][1];
        if (of->pair[n] == pair_alike || (of->pair[n] == pair_of_plants && *leafy && !leaves)) continue;
        if (xb < 0 || yb < 0 || xb >= view->width || yb >= view->height) continue;
        *leafy |= picture_shows_plant(job->picture, pixel_index(job, xb, yb));
        if (of->pair[n] == pair_may_differ || leaves) flag |= edge_between(job, x, y, xb, yb, leaves);
    }
    return flag;
}

/* Marks pixels on borders of ground classes, of those in `ask`: by the classes at their corners. */
static void mark_borders(uint8_t flags[hits_capacity], const bool ask[hits_capacity], const Job *job, const Tile *tile)
{
    const int width = tile->x1 - tile->x0, height = tile->y1 - tile->y0, columns = width + 1;
    uint16_t  corner[corner_capacity];
    bool      wanted[corner_capacity] = {false};
    for (int y = 0, k = 0; y < height; y++)
        for (int x = 0; x < width; x++, k++) {
            const int at = y * columns + x;
            if (ask[k]) wanted[at] = wanted[at + 1] = wanted[at + columns] = wanted[at + columns + 1] = true;
        }
    corner_materials(corner, job, tile, wanted);
    for (int y = 0, k = 0; y < height; y++) {
        const uint32_t *material = job->picture->material + pixel_index(job, tile->x0, tile->y0 + y);
        for (int x = 0; x < width; x++, k++)
            if (ask[k] && corners_differ(corner + y * columns + x, columns, material[x])) flags[k] |= refine_ground;
    }
}

void refine_flags(uint8_t flags[hits_capacity], const Job *job, const Tile *tile)
{
    enum { side = tile_side_samples };
    const View *view = &job->request->view;
    const int   x0 = tile->x0, y0 = tile->y0, width = tile->x1 - x0;
    uint32_t across[side + 1] = {0}, above[side] = {0}, below[side] = {0}; /* across[k]: pixels x0 + k - 1 and x0 + k */
    bool     ask[hits_capacity], any = false;
    /* the steps that give up rays refine no borders of ground */
    const bool grounds = job->scene.world->landscape && job->request->samples == 1 &&
                         job->request->bands & ~(1u << BAND_RADAR) && job->request->sampling == SAMPLING_ALL;
    const int left = x0 > 0 ? x0 - 1 : 0, right = tile->x1 < view->width ? tile->x1 : view->width - 1;
    if (y0 > 0) find_pairs(above, job, pixel_index(job, x0, y0 - 1), pixel_index(job, x0, y0), width);
    for (int y = y0; y < tile->y1; y++) {
        find_pairs(across + left + 1 - x0, job, pixel_index(job, left, y), pixel_index(job, left + 1, y), right - left);
        if (y + 1 < view->height) find_pairs(below, job, pixel_index(job, x0, y), pixel_index(job, x0, y + 1), width);
        for (int k = 0; k < width; k++) {
            const int        x = x0 + k, at = (y - y0) * width + k;
            const PixelPairs pairs = {{across[k], across[k + 1], above[k], below[k]}};
            bool             leafy;
            unsigned         flag = flags_of_pairs(&leafy, job, x, y, &pairs);
            const bool       smoothed = leafy && !(flag & refine_leaves);
            if (smoothed) flag &= ~(unsigned)(refine_sun | refine_shade | refine_ground);
            if (job->request->samples > 1)
                flag &= ~(unsigned)(refine_step | refine_scenery | refine_plants | refine_ground); /* all flags set */
            ask[at] = grounds && !(flag & refine_all) && !smoothed &&
                      job->picture->cover[pixel_index(job, x, y)] != SURFACE_NONE;
            any |= ask[at];
            flags[at] = (uint8_t)(flag & ~(unsigned)refine_leaves);
        }
        if (y + 1 < tile->y1) memcpy(above, below, sizeof above);
    }
    if (any) mark_borders(flags, ask, job, tile);
}

/* ---- ground --------------------------------------------------------------------------------- */

void recall_ground(Worker *w, const Job *job)
{
    const View       *view = &job->request->view;
    const Picture    *p = job->picture;
    const PixelBlock *block = &w->block;
    Hits             *hits = &w->samples.hits;
    Rays             *rays = &w->samples.rays;
    hits->count = rays->count = block->pixels;
    hits->columns = rays->columns = 0;
    hits->several = false;
    for (int i = 0; i < hits->count; i++) {
        const size_t px = pixel_index(job, block->x[i], block->y[i]);
        double       d_enu[3];
        view_ray(d_enu, view, block->x[i] + 0.5, block->y[i] + 0.5);
        hits->range_m[i] = p->range_m[px];
        hits->kind[i] = hit_ground;
        hits->entity[i] = 0;
        hits->part[i] = hits->model[i] = 0;
        hits->inside[i] = 0;
        hits->instance[i] = 0;
        rays->far_m[i] = INFINITY;
        for (int k = 0; k < 3; k++) {
            rays->o_enu[k][i] = view->p_enu[k];
            rays->d_enu[k][i] = d_enu[k];
            hits->p_enu[k][i] = view->p_enu[k] + (double)p->range_m[px] * d_enu[k];
            hits->n_geo[k][i] = hits->n_enu[k][i] = p->normal[k][px];
        }
        const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
        hits->p_enu[2][i] -= visibility_lift_at(job->scene.visibility, p_enu);
        w->samples.sun[i] = job->sun[px];
    }
    surface_cells_at(hits->surface, job->scene.world->cells, job->scene.world->landscape, hits->count, hits->p_enu[0],
                     hits->p_enu[1]);
    for (int i = 0; i < hits->count; i++)
        if (visibility_is_beyond(job->scene.visibility, hits->p_enu[0][i], hits->p_enu[1][i]))
            hits->surface[i] = p->cover[pixel_index(job, block->x[i], block->y[i])];
    for (int i = 0; i < hits->count; i++)
        hits->material[i] = (uint16_t)(hits->surface[i] ? job->scene.world->materials.surface[hits->surface[i]] : 0);
}
