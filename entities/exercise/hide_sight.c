/* entities/exercise/hide_sight.c: how much of an entity crowns, ground and a box hide, estimated. */
#include "entities/exercise/hide.h"

#include <stdlib.h>

/* ---- crowns ----------------------------------------------------------------------------------------- */

/* The crown of the prototypes of each kind in eight slices of the height: radius of the cylinder that holds nine tenths
 * of the slice's leaves and branches, over the height; and what they hide along a metre of a plant 1 m high, 1/m: mean
 * projected area over volume (half of a leaf's side, a quarter of a branch's skin: Cauchy). From the prototypes
 * (render/trace/plants; tests/sensor/test_hide_crowns.c). */
enum { slices = 8 };
typedef struct CrownSlice {
    float radius, per_m;
} CrownSlice;
static const CrownSlice crown[PLANT_STANDING][slices] = {
    [PLANT_PINE] = {{0.013f, 58.59f},
                    {0.013f, 32.06f},
                    {0.011f, 61.88f},
                    {0.151f, 2.35f},
                    {0.181f, 2.17f},
                    {0.173f, 3.03f},
                    {0.149f, 3.71f},
                    {0.095f, 9.74f}},
    [PLANT_ALDER] = {{0.012f, 65.56f},
                     {0.112f, 1.37f},
                     {0.162f, 3.97f},
                     {0.194f, 3.19f},
                     {0.195f, 3.78f},
                     {0.188f, 3.72f},
                     {0.154f, 6.62f},
                     {0.084f, 23.82f}},
    [PLANT_BIRCH] = {{0.009f, 79.68f},
                     {0.113f, 0.35f},
                     {0.162f, 3.22f},
                     {0.201f, 2.87f},
                     {0.243f, 2.01f},
                     {0.242f, 2.35f},
                     {0.225f, 3.26f},
                     {0.144f, 7.43f}},
    [PLANT_ENGLISH_OAK] = {{0.017f, 46.53f},
                           {0.203f, 3.78f},
                           {0.256f, 2.82f},
                           {0.285f, 2.03f},
                           {0.299f, 2.38f},
                           {0.289f, 3.78f},
                           {0.294f, 1.38f},
                           {0.298f, 0.09f}},
    [PLANT_SESSILE_OAK] = {{0.015f, 36.38f},
                           {0.077f, 2.08f},
                           {0.173f, 4.46f},
                           {0.218f, 3.41f},
                           {0.235f, 2.77f},
                           {0.246f, 4.38f},
                           {0.237f, 3.64f},
                           {0.235f, 0.50f}},
    [PLANT_RED_OAK] = {{0.015f, 52.82f},
                       {0.116f, 1.07f},
                       {0.163f, 4.53f},
                       {0.206f, 3.36f},
                       {0.242f, 2.46f},
                       {0.255f, 3.74f},
                       {0.240f, 3.59f},
                       {0.235f, 0.51f}},
    [PLANT_WHITE_OAK] = {{0.174f, 0.83f},
                         {0.249f, 2.71f},
                         {0.274f, 2.41f},
                         {0.318f, 1.65f},
                         {0.334f, 2.00f},
                         {0.301f, 3.35f},
                         {0.314f, 1.95f},
                         {0.408f, 0.11f}},
    [PLANT_BUSH] = {{0.525f, 0.30f},
                    {0.504f, 2.21f},
                    {0.528f, 1.41f},
                    {0.484f, 1.53f},
                    {0.446f, 2.13f},
                    {0.429f, 1.84f},
                    {0.422f, 1.86f},
                    {0.319f, 0.43f}},
    [PLANT_HEDGE] = {{0.470f, 0.61f},
                     {0.469f, 1.87f},
                     {0.466f, 1.24f},
                     {0.445f, 1.75f},
                     {0.416f, 1.65f},
                     {0.414f, 1.96f},
                     {0.378f, 1.88f},
                     {0.289f, 0.42f}},
};

void hide_crown(double *radius_m, double *per_m, PlantKind kind, int slice)
{
    *radius_m = (double)crown[kind][slice].radius, *per_m = (double)crown[kind][slice].per_m;
}

static const double clumped =
    0.75; /* share of the density that leaves in twigs have of leaves at random: from pictures */

/* Length of the level circle of a radius that a ray o + t d, t >= 0, passes between two heights. */
static double within(const double o[3], const double d[3], double radius_m, double low_m, double high_m)
{
    const double level = d[0] * d[0] + d[1] * d[1], b = o[0] * d[0] + o[1] * d[1];
    const double square = b * b - level * (o[0] * o[0] + o[1] * o[1] - radius_m * radius_m);
    double       from = 0, to = INFINITY;
    if (level > 1e-12) {
        if (!(square > 0)) return 0;
        from = fmax((-b - sqrt(square)) / level, 0), to = (-b + sqrt(square)) / level;
    } else if (o[0] * o[0] + o[1] * o[1] >= radius_m * radius_m) {
        return 0;
    }
    if (fabs(d[2]) > 1e-12) {
        const double a = (low_m - o[2]) / d[2], c = (high_m - o[2]) / d[2];
        from = fmax(from, fmin(a, c)), to = fmin(to, fmax(a, c));
    } else if (o[2] < low_m || o[2] > high_m) {
        return 0;
    }
    return fmax(to - from, 0);
}

/* What a plant hides along a ray: minus the logarithm of the chance to pass it. foot: of the plant, from the ray's
 * origin. */
static double depth_of(const Plant *plant, const double foot[3], const double d[3])
{
    const double height_m = plant_height_m(plant), width = plant->width / 128.0;
    double       depth = 0;
    for (int k = 0; k < slices; k++) {
        const CrownSlice *s = &crown[plant->kind][k];
        /* the middle of the slice, where the plant leans to */
        const double axis_m = height_m * (k + 0.5) / slices, tilt = plant_most_tilt_rad / 127;
        const double o[3] = {-foot[0] - axis_m * tilt * plant->lean[0], -foot[1] - axis_m * tilt * plant->lean[1],
                             -foot[2]};
        const double m =
            within(o, d, (double)s->radius * height_m * width, height_m * k / slices, height_m * (k + 1) / slices);
        depth += m * (double)s->per_m / (height_m * width);
    }
    return clumped * depth;
}

/* ---- ground, plants near a line ------------------------------------------------------------------------ */

Status hide_ground_open(HideGround *out, const HideWorld *world, const double about_m[2], double half_m)
{
    const WoodsConfig config = {.seed = world->seed,
                                .centre_m = {about_m[0], about_m[1]},
                                .half_width_m = half_m,
                                .most_trees = woods_most_trees,
                                .culture = world->culture};
    const HideJudge  *judge = world->judge;
    *out = (HideGround){.landscape = world->landscape, .culture = world->culture};
    Status status = woods_create(&out->woods, world->landscape, &config, NULL);
    if (status != STATUS_OK) out->landscape = NULL;
    if (status == STATUS_OK) status = hide_solids_open(&out->solids, world->culture, world->landscape, about_m, half_m);
    if (status == STATUS_OK && judge) status = judge->begin(judge->user, &out->woods);
    if (status == STATUS_OK) out->judge = judge;
    return status;
}

void hide_ground_close(HideGround *ground)
{
    if (ground->judge) ground->judge->end(ground->judge->user);
    if (ground->landscape) woods_destroy(&ground->woods);
    hide_solids_close(&ground->solids);
    *ground = (HideGround){0};
}

HideSight hide_sight(const Scenario *scenario)
{
    const double bearing_rad = scenario->seen.bearing_deg * rad_per_deg;
    HideSight    s = {
           {scenario->seen.range_m * sin(bearing_rad), scenario->seen.range_m * cos(bearing_rad), scenario->seen.height_m},
           0};
    s.range_m = v3_length(s.d_enu);
    v3_normalize(s.d_enu, s.d_enu);
    return s;
}

/* The triangles of a model at rest, body axes. */
static Status triangles_of(double (**out)[3][3], const Model *model)
{
    NodePose *pose = calloc((size_t)model->node_count + 1, sizeof *pose);
    double(*corner)[3][3] = calloc((size_t)model->triangle_count + 1, sizeof *corner);
    const Status status = pose && corner ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) model_pose(pose, model, NULL);
    for (int t = 0; status == STATUS_OK && t < model->triangle_count; t++) {
        const NodePose *at = &pose[model->part[model->triangle_part[t]].node];
        for (int c = 0; c < 3; c++) {
            m3_mul_v3(corner[t][c], at->r_body_from_node, model->vertex[model->triangle[t][c]]);
            v3_add(corner[t][c], corner[t][c], at->p_body);
        }
    }
    free(pose);
    if (status == STATUS_OK) *out = corner;
    else free(corner);
    return status;
}

/* The surface nearest to the observer in each cell of a grid across the line of sight, from points drawn evenly over
 * the triangles that face it: what other parts of the model hide is left out. */
typedef struct Silhouette {
    double u[3], v[3], d[3], cell_m;
    int    side;
    double (*p)[3]; /* [side * side] */
    double *near_m; /* [side * side]; -INFINITY: nothing */
} Silhouette;

static void draw_triangle(Silhouette *s, const double corner[3][3], double area_m2, uint64_t number)
{
    enum { most = 400 };
    const int count = (int)fmin(ceil(9 * area_m2 / (s->cell_m * s->cell_m)), most);
    for (int n = 0; n < count; n++) {
        const uint64_t at = 2 * (number * most + (uint64_t)n);
        double         a = random_uniform(1, 12, 0, at), b = random_uniform(1, 12, 0, at + 1), p[3];
        if (a + b > 1) a = 1 - a, b = 1 - b;
        for (int k = 0; k < 3; k++)
            p[k] = corner[0][k] + a * (corner[1][k] - corner[0][k]) + b * (corner[2][k] - corner[0][k]);
        const double i = floor(v3_dot(p, s->u) / s->cell_m) + s->side / 2,
                     j = floor(v3_dot(p, s->v) / s->cell_m) + s->side / 2;
        if (!(i >= 0 && j >= 0 && i < s->side && j < s->side)) continue;
        const int cell = (int)j * s->side + (int)i;
        if (v3_dot(p, s->d) <= s->near_m[cell]) continue;
        s->near_m[cell] = v3_dot(p, s->d);
        memcpy(s->p[cell], p, sizeof p);
    }
}

static double facing_m2(const double corner[3][3], const double d_body[3])
{
    double u[3], v[3], n[3];
    v3_sub(u, corner[1], corner[0]), v3_sub(v, corner[2], corner[0]);
    v3_cross(n, u, v);
    return fmax(0.5 * v3_dot(n, d_body), 0);
}

Status hide_points(HidePoints *out, const HideShape *shape, const double d_body[3])
{
    static const double parts = 160; /* cells that the facing triangles would fill */
    Silhouette          s = {.d = {d_body[0], d_body[1], d_body[2]}};
    double              sum = 0;
    for (int t = 0; t < shape->count; t++) sum += facing_m2((const double(*)[3])shape->corner[t], d_body);
    out->count = 0;
    if (!(sum > 0)) return STATUS_OK;
    const double other[3] = {fabs(d_body[2]) < 0.9 ? 0 : 1, 0, fabs(d_body[2]) < 0.9 ? 1 : 0};
    v3_cross(s.u, other, d_body);
    v3_normalize(s.u, s.u);
    v3_cross(s.v, d_body, s.u);
    s.cell_m = sqrt(sum / parts);
    s.side = 2 * (int)fmin(ceil(shape->radius_m / s.cell_m) + 1, 200);
    const size_t cells = (size_t)s.side * (size_t)s.side;
    s.p = malloc(cells * sizeof *s.p), s.near_m = malloc(cells * sizeof *s.near_m);
    if (s.p && s.near_m) {
        for (size_t n = 0; n < cells; n++) s.near_m[n] = -INFINITY;
        for (int t = 0; t < shape->count; t++) {
            const double area_m2 = facing_m2((const double(*)[3])shape->corner[t], d_body);
            if (area_m2 > 0) draw_triangle(&s, (const double(*)[3])shape->corner[t], area_m2, (uint64_t)t);
        }
        for (size_t n = 0; n < cells && out->count < hide_points_most; n++)
            if (isfinite(s.near_m[n])) memcpy(out->p_body[out->count++], s.p[n], sizeof s.p[n]);
    }
    const bool done = s.p && s.near_m;
    free(s.p), free(s.near_m);
    return done ? STATUS_OK : STATUS_NO_MEMORY;
}

Status hide_shape_open(HideShape *out, const Model *model)
{
    *out = (HideShape){.model = model, .count = model->triangle_count, .radius_m = model->radius_m};
    return triangles_of(&out->corner, model);
}

void hide_shape_close(HideShape *shape)
{
    free(shape->corner);
    *shape = (HideShape){0};
}

/* Whether something solid stands in a ray's way. */
static bool box_hides(const HideBox *box, const double p_enu[3], const double d_enu[3])
{
    const double dx = p_enu[0] - box->p_enu[0], dy = p_enu[1] - box->p_enu[1];
    /* body axes: forward, right, down */
    const double o[3] = {dx * box->nose[0] + dy * box->nose[1], dx * box->nose[1] - dy * box->nose[0],
                         box->p_enu[2] - p_enu[2]};
    const double d[3] = {d_enu[0] * box->nose[0] + d_enu[1] * box->nose[1],
                         d_enu[0] * box->nose[1] - d_enu[1] * box->nose[0], -d_enu[2]};
    double       from = 0, to = INFINITY;
    for (int k = 0; k < 3; k++) { /* its bounding box, first */
        const double low = box->shape.model->box_low[k], high = box->shape.model->box_high[k];
        if (fabs(d[k]) < 1e-12) {
            if (o[k] < low || o[k] > high) return false;
            continue;
        }
        const double a = (low - o[k]) / d[k], b = (high - o[k]) / d[k];
        from = fmax(from, fmin(a, b)), to = fmin(to, fmax(a, b));
    }
    for (int t = 0; to > from && t < box->shape.count; t++)
        if (hide_triangle_meets((const double(*)[3])box->shape.corner[t], o, d)) return true;
    return false;
}

/* Whether the ground rises above a ray. */
static bool ground_hides(const Landscape *landscape, const double p_enu[3], const double d_enu[3], double range_m)
{
    static const double first_m = 6, grows = 1.15, highest_m = 150;
    for (double t = first_m; t < range_m && t * d_enu[2] < highest_m; t *= grows) {
        const double z_m =
            elevation_height(&landscape->elevation, p_enu[0] + t * d_enu[0], p_enu[1] + t * d_enu[1], NULL);
        if (p_enu[2] + t * d_enu[2] < z_m) return true;
    }
    return false;
}

/* ---- all of it ------------------------------------------------------------------------------------------- */

/* The plants of squares near the line whose crowns may be in its way. Returns how many there are, of which the first
 * hide_plants_most are in the list. */
static int plants_along(const Plant *list[hide_plants_most], const HideGround *ground, const HidePose *pose,
                        const HideSight *sight)
{
    static const double tallest_m = 30, beside_m = 14;
    const Woods        *w = &ground->woods;
    const double        level = hypot(sight->d_enu[0], sight->d_enu[1]);
    const double long_m = fmin(level * sight->range_m, tallest_m * level / fmax(sight->d_enu[2], 0.02)) + beside_m;
    const double u[2] = {sight->d_enu[0] / fmax(level, 1e-9), sight->d_enu[1] / fmax(level, 1e-9)};
    int          count = 0;
    double       low[2], high[2];
    for (int k = 0; k < 2; k++) {
        const double a = pose->p_enu[k] - w->origin_enu[k], b = a + u[k] * long_m;
        low[k] = floor((fmin(a, b) - beside_m) / woods_square_m),
        high[k] = floor((fmax(a, b) + beside_m) / woods_square_m);
    }
    for (int j = (int)clamp(low[1], 0, w->ny); j <= (int)clamp(high[1], -1, w->ny - 1); j++)
        for (int i = (int)clamp(low[0], 0, w->nx); i <= (int)clamp(high[0], -1, w->nx - 1); i++)
            for (uint32_t n = w->first[j * w->nx + i]; n < w->first[j * w->nx + i + 1]; n++) {
                const Plant *p = &w->plant[n];
                const double x = (double)p->p_m[0] + w->origin_enu[0], y = (double)p->p_m[1] + w->origin_enu[1];
                const double dx = x - pose->p_enu[0], dy = y - pose->p_enu[1];
                const double along = dx * u[0] + dy * u[1], across = fabs(dx * u[1] - dy * u[0]);
                if (along < -beside_m || along > long_m || across > beside_m) continue;
                if (count < hide_plants_most) list[count] = p;
                count++;
            }
    return count;
}

static void point_of(double p_enu[3], const HidePose *pose, const double b[3])
{
    p_enu[0] = pose->p_enu[0] + b[0] * pose->nose[0] + b[1] * pose->nose[1];
    p_enu[1] = pose->p_enu[1] + b[0] * pose->nose[1] - b[1] * pose->nose[0];
    p_enu[2] = pose->p_enu[2] - b[2];
}

/* What is built between the vehicle and the observer. */
static int solids_along(int list[hide_solids_most], const HideGround *ground, const HidePose *pose,
                        const HidePoints *points, const HideSight *sight)
{
    double radius_m = 0;
    for (int n = 0; n < points->count; n++)
        radius_m = fmax(radius_m, hypot(points->p_body[n][0], points->p_body[n][1]));
    return hide_solids_along(list, &ground->solids, pose->p_enu, radius_m, sight->d_enu, sight->range_m);
}

double hide_occlusion(int *left_out, const HideGround *ground, const HidePose *pose, const HidePoints *points,
                      const HideSight *sight, const HideBox *box)
{
    static const double      deepest = 8; /* e^-8 is nothing */
    const Plant             *list[hide_plants_most];
    const int                all_plants = plants_along(list, ground, pose, sight);
    const int                plants = all_plants < hide_plants_most ? all_plants : hide_plants_most;
    static _Thread_local int solid[hide_solids_most];
    const int                all_solids = solids_along(solid, ground, pose, points, sight);
    const int                solids = all_solids < hide_solids_most ? all_solids : hide_solids_most;
    const Woods             *w = &ground->woods;
    double                   seen = 0;
    if (left_out) *left_out = all_plants - plants + all_solids - solids;
    for (int n = 0; n < points->count; n++) {
        double p[3], depth = 0;
        point_of(p, pose, points->p_body[n]);
        if (box && box_hides(box, p, sight->d_enu)) continue;
        if (hide_solids_meet(&ground->solids, solid, solids, p, sight->d_enu)) continue;
        if (n % 8 == 0 && ground_hides(ground->landscape, p, sight->d_enu, sight->range_m)) depth = deepest;
        for (int k = 0; k < plants && depth < deepest; k++) {
            double foot[3];
            for (int c = 0; c < 3; c++) foot[c] = (double)list[k]->p_m[c] + w->origin_enu[c] - p[c];
            depth += depth_of(list[k], foot, sight->d_enu);
        }
        seen += depth < deepest ? exp(-depth) : 0;
    }
    return points->count ? 1 - seen / points->count : 0;
}

bool hide_judged(double *occlusion, const HideGround *ground, const HidePose *pose, const HidePoints *points,
                 const HideSight *sight, const HideBox *box)
{
    double              o[3][hide_points_most], d[3][hide_points_most], eye_enu[3];
    const double *const o_enu[3] = {o[0], o[1], o[2]}, *const d_enu[3] = {d[0], d[1], d[2]};
    uint8_t          dark[hide_points_most] = {0};
    int              hidden = 0;
    const HideJudge *judge = ground->judge;
    if (!judge || points->count == 0) return false;
    v3_add_scaled(eye_enu, pose->p_enu, sight->range_m, sight->d_enu);
    for (int n = 0; n < points->count; n++) {
        double p[3];
        point_of(p, pose, points->p_body[n]);
        for (int k = 0; k < 3; k++) o[k][n] = p[k], d[k][n] = sight->d_enu[k];
    }
    if (judge->dark(judge->user, dark, eye_enu, points->count, o_enu, d_enu, sight->range_m) != STATUS_OK) return false;
    static _Thread_local int solid[hide_solids_most];
    const int                all_solids = solids_along(solid, ground, pose, points, sight);
    const int                solids = all_solids < hide_solids_most ? all_solids : hide_solids_most;
    for (int n = 0; n < points->count; n++) {
        const double p[3] = {o[0][n], o[1][n], o[2][n]};
        hidden += dark[n] || hide_solids_meet(&ground->solids, solid, solids, p, sight->d_enu) ||
                  (box && box_hides(box, p, sight->d_enu)) ||
                  ground_hides(ground->landscape, p, sight->d_enu, sight->range_m);
    }
    *occlusion = (double)hidden / points->count;
    return true;
}
