/* sensor/radar/shot_scenery.c: scenery in a shot: which of it is near what the beam lights, and the echoes of walls,
 * roofs and other flat faces, directly and by way of the ground before them. */
#include "sensor/radar/shot_scenery_private.h"

/* ---- what is near --------------------------------------------------------------------------------- */

Status shot_scenery_open(RadarShot *shot)
{
    const SceneryFrame  *frame = shot->radar->scenery ? scenery_frame_in(shot->visibility) : NULL;
    const SceneryTracer *tracer = shot->scene->world->scenery;
    double               low[3] = {0, 0, -1e5}, high[3] = {0, 0, 1e5};
    if (!frame || !tracer) return STATUS_OK;
    const Scenery *scenery = scenery_frame_of(frame);
    int           *list = arena_alloc_raw(shot->arena, (size_t)scenery->objects + 1, sizeof *list);
    ShotScenery   *s = arena_alloc(shot->arena, 1, sizeof *s);
    if (!list || !s) return STATUS_NO_MEMORY;
    shot_lit_rectangle(low, high, shot);
    *s = (ShotScenery){.frame = frame, .of = scenery, .list = list};
    s->count = scenery_frame_near(list, frame, low, high, 0);
    s->box = arena_alloc(shot->arena, (size_t)s->count + 1, sizeof *s->box);
    if (!s->box) return STATUS_NO_MEMORY;
    for (int i = 0; i < s->count; i++) {
        double box_low[3], box_high[3];
        if (scenery->object[list[i]].kind != SCENERY_BUILDINGS ||
            !scenery_tracer_box(tracer, list[i], box_low, box_high))
            continue;
        double *box = s->box[s->boxes++];
        for (int k = 0; k < 2; k++) box[k] = box_low[k], box[2 + k] = box_high[k];
    }
    shot->scenery = s;
    shot->frame->scenery.objects = s->count;
    return STATUS_OK;
}

uint8_t shot_bare_surface(const RadarShot *shot, uint8_t surface, double x_m, double y_m)
{
    const ShotScenery *s = shot->scenery;
    if (surface != SURFACE_BUILT || !s) return surface;
    for (int i = 0; i < s->boxes; i++) {
        const double *box = s->box[i];
        if (x_m >= box[0] && y_m >= box[1] && x_m <= box[2] && y_m <= box[3]) return SURFACE_ROAD;
    }
    return surface;
}

bool shot_scenery_lit(const RadarShot *shot, int object)
{
    const PosedEntity *posed = scenery_frame_posed(shot->scenery->frame, object);
    Sight              to;
    if (posed->model < 0) return false;
    if (!skips(shot->scene->skips_off, SKIP_SCENERY)) return true;
    shot_sight(&to, shot, posed->centre_enu, posed->radius_m);
    if (to.range_m < 2 * posed->radius_m) return true;
    return to.within && shot_off_axis(shot, &to) <= shot->scenery->widest + posed->radius_m / to.range_m;
}

/* ---- faces of an object -------------------------------------------------------------------------- */

enum { task_triangles = 256, pieces_most = 150000, finest_level = 0, coarsest_level = 5 };

static const double finest_m = 0.125;      /* side of the smallest pieces; others are 2^n of it */
static const double mirrors_within = 0.25; /* off the mirror direction, sine; beyond it edges alone would return */
static const double upright = 0.1736;      /* z of the normal of a wall, at most: 10 degrees */
static const double least_m2 = 1e-10;      /* of a piece by way of the ground */
static const double own_m = 0.05;          /* scenery met so much before a piece is its own */

/* What is common to a part of a model. */
typedef struct FacePart {
    const FacadeRow *row; /* NULL: it is not there */
    RadarSurface     surface;
    int              source;
} FacePart;

typedef struct FaceTask {
    const PosedEntity *posed;
    const Model       *model;
    const FacePart    *part;
    const NodePose    *node;
    uint64_t           id;
    int                first, end; /* triangles */
    int                room, from; /* pieces at most; its points begin at 2 from */
    int                kept, hidden, by_ground, skipped;
} FaceTask;

typedef struct FaceJob {
    const RadarShot *shot;
    FacadeLook       look;
    FaceTask        *task;
    RadarPoint      *point;
    double           coarser; /* factor on sides, where there would be too many pieces */
    double           cell_m;  /* range resolution */
    double           beam_m;  /* of range: sides that the beam does not tell apart */
} FaceJob;

/* Pieces of a task that wait for their sight lines. */
typedef struct FaceBlock {
    const FaceJob *job;
    FaceTask      *task;
    const Facade  *facade; /* that is being cut */
    int            source;
    bool           mirrored, grounded;
    int            count;
    Piece          piece[piece_block];
    Facade         of[piece_block];
    Sight          sight[piece_block];
    double         p_enu[piece_block][3], slack_m[piece_block];
    int            source_of[piece_block];
    bool           mirrors[piece_block], grounds[piece_block];
} FaceBlock;

static RadarPoint *next_point(const FaceBlock *b)
{
    return &b->job->point[2 * (size_t)b->task->from + (size_t)b->task->kept];
}

/* Adds the echo of a piece by the ground before it, where that is seen. */
static void add_by_ground(FaceBlock *b, int i)
{
    const RadarShot *shot = b->job->shot;
    const Facade    *f = &b->of[i];
    const Elevation *elevation = &shot->scene->world->landscape->elevation;
    const double    *v = shot->scene->v_enu_mps;
    double           p_ground[3], n[3], p[3], back[3];
    FacadeGround     ground;
    ScatterMatrix    s;
    for (int k = 0; k < 2; k++) p_ground[k] = b->p_enu[i][k] + 0.3 * f->plane.n[k];
    p_ground[2] = elevation_height(elevation, p_ground[0], p_ground[1], n);
    if (!isfinite(p_ground[2]) || !facade_ground(&ground, f, &b->piece[i], &b->job->look, p_ground, n)) return;
    memcpy(p, ground.mirror_enu, sizeof p);
    p[2] = elevation_height(elevation, p[0], p[1], NULL);
    if (!isfinite(p[2])) return;
    const uint8_t surface =
        shot_bare_surface(shot, (uint8_t)landscape_surface(shot->scene->world->landscape, p[0], p[1]), p[0], p[1]);
    const GroundSurface of = ground_surface(&shot->radar->mirror.row[surface], b->job->look.frequency_hz);
    facade_by_ground(&s, f, &b->piece[i], &b->job->look, &ground, &of);
    if (!(4 * pi_rad * (scatter_power(s.hh) + scatter_power(s.vv)) > least_m2)) return;
    if (!shot_ground_is_seen(shot, p, b->p_enu[i])) return;
    /* the path by the ground as it is where it mirrors: by Fermat right to second order in its height over the plane */
    v3_sub(back, b->p_enu[i], p);
    double to[3];
    v3_sub(to, p, shot->p_enu);
    const double by_m = v3_length(to) + v3_length(back), d_rate = -v3_dot(b->sight[i].d_enu, v);
    v3_scale(to, 1 / fmax(v3_length(to), 1e-3), to);
    RadarPoint *q = next_point(b);
    *q = (RadarPoint){.path_m = b->sight[i].range_m + by_m - 2 * shot->reference_m,
                      .path_per_pulse_m =
                          (d_rate - v3_dot(to, v) - 2 * shot->reference_rate_mps) / shot->preset->wave.repeat_hz,
                      .same = shot->preset->transmits_h ? s.hh : s.vv,
                      .other = shot->preset->transmits_h ? s.vh : s.hv,
                      .share = 1,
                      .widest = shot->scenery->widest,
                      .source = b->source_of[i] + 1};
    memcpy(q->p_enu, ground.foot_enu, sizeof q->p_enu);
    b->task->kept++;
    b->task->by_ground++;
}

static void add_direct(FaceBlock *b, int i)
{
    static const double still[3] = {0, 0, 0};
    const RadarShot    *shot = b->job->shot;
    double              to_antenna[3], h[3], v[3];
    ScatterMatrix       s;
    facade_echo(&s, &b->of[i], &b->piece[i], &b->job->look, b->mirrors[i]);
    v3_scale(to_antenna, -1, b->sight[i].d_enu);
    scatter_basis(h, v, to_antenna);
    scatter_turn(&s, h, v, shot->right);
    if (!isfinite(scatter_power(s.hh) + scatter_power(s.vv) + scatter_power(s.hv))) return;
    RadarPoint *q = next_point(b);
    *q = (RadarPoint){.path_m = 2 * (b->sight[i].range_m - shot->reference_m),
                      .path_per_pulse_m = 2 * (shot_range_rate(shot, &b->sight[i], still) - shot->reference_rate_mps) /
                                          shot->preset->wave.repeat_hz,
                      .same = shot->preset->transmits_h ? s.hh : s.vv,
                      .other = shot->preset->transmits_h ? s.vh : s.hv,
                      .share = 1,
                      .widest = shot->scenery->widest,
                      .source = b->source_of[i] + 1};
    memcpy(q->p_enu, b->p_enu[i], sizeof q->p_enu);
    b->task->kept++;
}

/* Looks at the pieces that wait, and adds the echoes of those in sight. */
static void flush(FaceBlock *b)
{
    bool hidden[piece_block];
    if (b->count == 0) return;
    shot_hidden(hidden, b->job->shot, b->job->shot->scene->view->p_enu, b->sight, b->slack_m, b->count, -1);
    for (int i = 0; i < b->count; i++) {
        b->task->hidden += hidden[i];
        if (hidden[i]) continue;
        add_direct(b, i);
        if (b->grounds[i]) add_by_ground(b, i);
    }
    b->count = 0;
}

static void take_piece(void *user, const Piece *piece)
{
    FaceBlock       *b = user;
    const RadarShot *shot = b->job->shot;
    const int        i = b->count;
    Sight           *to = &b->sight[i];
    piece_place(b->p_enu[i], &b->facade->plane, piece->middle[0], piece->middle[1]);
    shot_sight(to, shot, b->p_enu[i], 0);
    const double cosine = -v3_dot(to->d_enu, b->facade->plane.n);
    if (!to->within || !(cosine > 1e-3) || shot_off_axis(shot, to) > shot->scenery->widest) return;
    b->piece[i] = *piece;
    b->of[i] = *b->facade;
    b->mirrors[i] = b->mirrored, b->grounds[i] = b->grounded;
    b->source_of[i] = b->source;
    /* rays that bend find an object raised as a whole, by its middle, and a piece by its own place */
    const double uneven_m = 2 * visibility_bend(shot->visibility) * to->range_m * b->task->posed->radius_m;
    b->slack_m[i] = own_m + uneven_m / fmax(cosine, 0.05);
    if (++b->count == piece_block) flush(b);
}

/* ---- how finely a triangle is cut ----------------------------------------------------------------- */

static double level_m(double side_m, double coarser)
{
    const double level = floor(log2(clamp(side_m / finest_m, 1e-3, 1e6)));
    return finest_m * exp2(clamp(level, finest_level, coarsest_level)) * coarser;
}

/* Sides of its pieces. False: it returns nothing that counts. */
static bool sides_of(double side_m[2], bool *mirrored, bool *grounded, const FaceJob *job, const Facade *f,
                     const double corner[3][3])
{
    double middle[3], to[3], to_image[3], off[2], aside[2];
    for (int k = 0; k < 3; k++) middle[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
    v3_sub(to, job->shot->p_enu, middle);
    const double range_m = v3_length(to), near_m = facade_piece_m(job->look.k, range_m);
    v3_scale(to, 1 / fmax(range_m, 1e-3), to);
    facade_off_mirror(off, &f->plane, to, to);
    memcpy(to_image, to, sizeof to);
    to_image[2] = -to_image[2];
    facade_off_mirror(aside, &f->plane, to, to_image);
    *mirrored = fabs(off[0]) < mirrors_within && fabs(off[1]) < mirrors_within;
    *grounded = fabs(f->plane.n[2]) < upright && fabs(aside[0]) < mirrors_within &&
                job->shot->scene->world->landscape && job->shot->radar->ground_bounce;
    for (int k = 0; k < 2; k++) {
        side_m[k] = fmin(2, fmax(0.5 * job->cell_m / fmax(fabs(off[k]), 1e-3), job->beam_m * range_m));
        if (*mirrored) side_m[k] = fmin(side_m[k], fmin(near_m, 0.25 * job->cell_m / fmax(fabs(off[k]), 1e-3)));
        if (*grounded) side_m[k] = fmin(side_m[k], fmin(near_m, 0.25 * job->cell_m / fmax(fabs(aside[k]), 1e-3)));
        if ((*mirrored || *grounded) && f->row->uneven_m > 0)
            side_m[k] = fmin(side_m[k], 0.5 * f->row->uneven_length_m);
        side_m[k] = level_m(side_m[k], job->coarser);
    }
    return true;
}

/* Corners of a triangle, ENU; false: it is left out. */
static bool face_of(Facade *f, double corner[3][3], int *source, const FaceJob *job, FaceTask *task, int triangle)
{
    const RadarShot *shot = job->shot;
    const Model     *m = task->model;
    const int        part = m->triangle_part[triangle];
    const FacePart  *of = &task->part[part];
    const NodePose  *node = &task->node[m->part[part].node];
    double           to[3], middle[3];
    if (!of->row) return false;
    for (int v = 0; v < 3; v++) {
        double body[3];
        m3_mul_v3(body, node->r_body_from_node, m->vertex[m->triangle[triangle][v]]);
        v3_add(body, body, node->p_body);
        m3_mul_v3(corner[v], task->posed->r_enu_from_body, body);
        v3_add(corner[v], corner[v], task->posed->p_enu);
    }
    /* the model's body axes have z down: turned as a whole, so triangles keep their sense */
    if (!(piece_plane(&f->plane, (const double(*)[3])corner) > 1e-4)) return false;
    v3_sub(to, shot->p_enu, corner[0]);
    if (!(v3_dot(to, f->plane.n) > 0)) return false;
    double radius_m = 0;
    for (int k = 0; k < 3; k++) middle[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
    for (int v = 0; v < 3; v++) {
        v3_sub(to, corner[v], middle);
        radius_m = fmax(radius_m, v3_length(to));
    }
    Sight sight;
    shot_sight(&sight, shot, middle, radius_m);
    const bool lit = sight.range_m < 2 * radius_m ||
                     (sight.within && shot_off_axis(shot, &sight) <= shot->scenery->widest + radius_m / sight.range_m);
    if (!lit && skips(shot->scene->skips_off, SKIP_SCENERY)) {
        task->skipped++;
        return false;
    }
    f->row = of->row;
    f->surface = of->surface;
    f->number = (uint32_t)triangle;
    /* of a plane: object, part, and the plane by its direction and distance, coarse enough for rounding */
    f->bumps = task->id ^ (uint64_t)(part + 1) << 40;
    for (int k = 0; k < 3; k++)
        f->bumps = (f->bumps ^ (uint64_t)llround(16 * f->plane.n[k] + 0.37)) * 0x9e3779b97f4a7c15u;
    f->bumps ^= (uint64_t)llround(4 * f->plane.offset_m + 0.37);
    *source = of->source;
    return true;
}

static void count_task(void *user, int worker, int number)
{
    FaceJob  *job = user;
    FaceTask *task = &job->task[number];
    double    room = 0;
    (void)worker;
    task->skipped = 0;
    for (int t = task->first; t < task->end; t++) {
        Facade f;
        double corner[3][3], side_m[2];
        int    source;
        bool   mirrored, grounded;
        if (!face_of(&f, corner, &source, job, task, t)) continue;
        if (sides_of(side_m, &mirrored, &grounded, job, &f, (const double(*)[3])corner))
            room += pieces_bound(&f.plane, (const double(*)[3])corner, side_m);
    }
    task->room = (int)fmin(room, 1e6);
    task->skipped = 0;
}

static void cut_task(void *user, int worker, int number)
{
    static _Thread_local FaceBlock block;
    FaceJob                       *job = user;
    FaceBlock                     *b = &block;
    (void)worker;
    b->job = job;
    b->task = &job->task[number];
    b->count = 0;
    for (int t = b->task->first; t < b->task->end; t++) {
        Facade f;
        double corner[3][3], side_m[2];
        if (!face_of(&f, corner, &b->source, job, b->task, t)) continue;
        if (!sides_of(side_m, &b->mirrored, &b->grounded, job, &f, (const double(*)[3])corner)) continue;
        f.number ^= (uint32_t)ilogb(side_m[0] / finest_m) << 24 ^ (uint32_t)ilogb(side_m[1] / finest_m) << 28;
        b->facade = &f;
        pieces_cut(&f.plane, (const double(*)[3])corner, side_m, take_piece, b);
    }
    flush(b);
}

/* ---- all of it ------------------------------------------------------------------------------------ */

/* Sources and surfaces of the parts of an object. */
static Status know_parts(FaceTask *task, RadarShot *shot, int object)
{
    const Scenery       *scenery = shot->scenery->of;
    const SceneryObject *o = &scenery->object[object];
    const SeekerRadar   *r = shot->radar;
    const Model         *m = &scenery->model[o->model];
    const PosedEntity   *posed = scenery_frame_posed(shot->scenery->frame, object); /* with its damage by now */
    const int            records = scenery->part_first ? scenery->part_first[o->model] : -1;
    FacePart            *part = arena_alloc(shot->arena, (size_t)m->part_count + 1, sizeof *part);
    NodePose            *node = arena_alloc(shot->arena, (size_t)m->node_count + 1, sizeof *node);
    if (!part || !node) return STATUS_NO_MEMORY;
    model_pose(node, m, NULL);
    for (int p = 0; p < m->part_count; p++) {
        const ModelPart *of = &m->part[p];
        const char      *material =
            posed->damage && *of->damage_material[posed->damage] ? of->damage_material[posed->damage] : of->material;
        const int known = radar_materials_find(&r->materials, material);
        if (of->damage_hidden >> posed->damage & 1) continue;
        const uint64_t record = records >= 0 ? scenery->part_of[records + p] : 0;
        const Status   status = shot_source(&part[p].source, shot, object, record ? record : o->id);
        if (status != STATUS_OK) return status;
        radar_surface(&part[p].surface, &r->materials.material[known >= 0 ? known : 0], shot->preset->wave.centre_hz);
        part[p].row = facade_row(&r->facades, material);
    }
    *task = (FaceTask){.posed = posed, .model = m, .part = part, .node = node, .id = o->id};
    return STATUS_OK;
}

static Status list_tasks(FaceTask **out, int *count, RadarShot *shot)
{
    const ShotScenery *s = shot->scenery;
    size_t             most = 0;
    *count = 0;
    for (int i = 0; i < s->count; i++)
        most += (size_t)(s->of->model[s->of->object[s->list[i]].model].triangle_count / task_triangles) + 1;
    *out = arena_alloc(shot->arena, most + 1, sizeof **out);
    if (!*out) return STATUS_NO_MEMORY;
    for (int i = 0; i < s->count; i++) {
        const SceneryObject *o = &s->of->object[s->list[i]];
        FaceTask             task;
        if (o->kind != SCENERY_BUILDINGS) continue;
        if (!shot_scenery_lit(shot, s->list[i])) continue;
        const Status status = know_parts(&task, shot, s->list[i]);
        if (status != STATUS_OK) return status;
        for (int t = 0; t < task.model->triangle_count; t += task_triangles) {
            task.first = t;
            task.end =
                t + task_triangles < task.model->triangle_count ? t + task_triangles : task.model->triangle_count;
            (*out)[(*count)++] = task;
        }
    }
    return STATUS_OK;
}

static void run_all(FaceJob *job, int tasks, void (*run)(void *user, int worker, int task))
{
    if (job->shot->pool) pool_run(job->shot->pool, tasks, run, job);
    else
        for (int t = 0; t < tasks; t++) run(job, 0, t);
}

Status shot_faces(RadarShot *shot)
{
    SeekerRadar *r = shot->radar;
    const double wavelength_m = shot->preset->antenna.wavelength_m;
    FaceJob      job = {
             .shot = shot,
             .look = {.frequency_hz = shot->preset->wave.centre_hz, .k = 2 * pi_rad / wavelength_m, .band = shot_band(shot)},
             .coarser = 1,
             .cell_m = light_mps / (2 * shot->preset->wave.bandwidth_hz),
             .beam_m = asin(shot_null(shot)) / 128};
    int tasks, room;
    memcpy(job.look.p_enu, shot->p_enu, sizeof job.look.p_enu);
    memcpy(job.look.right, shot->right, sizeof job.look.right);
    const Status status = list_tasks(&job.task, &tasks, shot);
    if (status != STATUS_OK) return status;
    for (;; job.coarser *= 2) {
        int64_t sum = 0;
        run_all(&job, tasks, count_task);
        for (int t = 0; t < tasks; t++) {
            job.task[t].from = (int)fmin((double)sum, INT32_MAX);
            sum += job.task[t].room;
        }
        room = (int)fmin((double)sum, INT32_MAX / 4);
        if (sum <= pieces_most || job.coarser > 1000) break; /* as many as triangles */
    }
    job.point = radar_points_room(&r->points, 2 * room + 1); /* one each way */
    if (!job.point) return STATUS_NO_MEMORY;
    run_all(&job, tasks, cut_task);
    RadarSceneryCount *n = &shot->frame->scenery;
    for (int t = 0; t < tasks; t++) {
        const FaceTask *task = &job.task[t];
        memmove(r->points.point + r->points.count, job.point + 2 * (size_t)task->from,
                (size_t)task->kept * sizeof *job.point);
        r->points.count += task->kept;
        n->pieces += task->kept - task->by_ground;
        n->hidden += task->hidden;
        n->by_ground += task->by_ground;
        n->skipped += task->skipped;
    }
    return STATUS_OK;
}
