/* sensor/node/session/session_frame.c: one frame of a session: the snapshot, the request, what is rendered and
 * measured, its record. */
#include "sensor/node/session/session_private.h"

#include "sensor/node/choices/choices.h"
#include "sensor/verify/saved_frame/frame_save.h"
#include "sensor/publish/consumers/consume_pairs.h"
#include "sensor/frame/frame_world.h"

#include <assert.h>

/* Computes how a stationary point at the image centre moves on the image. */
static void rate_of_scene(double rate_px_s[2], const Eye *eye, const Picture *picture)
{
    const size_t middle = (size_t)(picture->height / 2) * (size_t)picture->width + (size_t)(picture->width / 2);
    double       v_cam_mps[3];
    m3_tmul_v3(v_cam_mps, eye->state.r_ecef_from_cam, eye->state.v_ecef_mps);
    seeker_scene_rate(rate_px_s, eye->w_cam_rps, v_cam_mps, eye->view.focal_px, picture->range_m[middle]);
}

/* Notes what a live frame gives up in the recording. */
static void note_verdict(const Session *s, unsigned verdict, const FrameTime *when)
{
    char text[frame_verdict_text_size];
    assert(verdict >> verdict_count == 0);
    for (int i = 0; s->shared->note && i < verdict_count; i++) {
        if (!(verdict >> i & 1)) continue;
        frame_verdict_text(text, 1u << i, when->number, when->t_s);
        s->shared->note(s->shared->user, text);
    }
}

/* What this frame gives up: by choice of a live node, or as its recording says. */
static unsigned judge(const Session *s, const FrameTime *when)
{
    const SessionShared *shared = s->shared;
    if (!shared->live || !shared->choose) return frame_verdicts_of(s->verdicts, when->number, when->t_s);
    const unsigned verdict = shared->choose(shared->user, when);
    note_verdict(s, verdict, when);
    return verdict;
}

/* Range to where the aim is, or was last, m; NAN: never known. */
static double aim_range(const Eye *eye)
{
    double to_aim[3];
    v3_sub(to_aim, eye->p_aim_ecef, eye->state.p_ecef);
    return eye->aim_known ? v3_length(to_aim) : NAN;
}

static void make_request(RenderRequest *request, const Session *s, const Eye *eye, double t_s)
{
    const Config *config = s->shared->config;
    *request = (RenderRequest){.view = eye->view,
                               .bands = s->shared->bands,
                               .optical = config_optical(config),
                               .lateral = {s->shared->sensors->lateral[0], s->shared->sensors->lateral[1]},
                               .sky_samples = config->sensor.sky_samples,
                               .sky_visibility = config->sensor.sky_visibility,
                               .refraction = config->sensor.refraction,
                               .samples = config->sensor.samples,
                               .hidden_entity = eye->hidden,
                               .t_s = t_s,
                               .low_plants_m = s->shared->world->forest ? config->terrain.woods_low_m : 0,
                               .budget = config->quality.budget,
                               .skips_off = s->shared->no_skip ? skips_all_off : 0};
    if (config_adaptive(config)) {
        request->edge_samples = config->sensor.edge_samples;
        request->target_samples = config->sensor.target_samples;
    }
    consumers_request(request, s->wants);
    instruments_request(request, &s->instruments, s->wants);
    if (s->shared->bands >> BAND_RADAR & 1) {
        const double range_m = eye->aim_known ? aim_range(eye) : 1000;
        request->profile_bins = config->radar.bins;
        request->profile_bin_m = config->radar.bin_m;
        request->profile_near_m = fmax(0, range_m - 0.5 * config->radar.bins * config->radar.bin_m);
    }
}

/* Renders the view's picture once and lists its planes. */
static Status look(FrameView *view, const Session *s, const RenderRequest *request, const FrameLight *light,
                   Arena *arena)
{
    const Status status =
        render(&view->picture, s->shared->world, &view->snapshot, request, &light->air, s->shared->pool, arena);
    if (status != STATUS_OK) return status;
    if (view->picture.normal[0]) frame_turn_normals(&view->picture, light->r_host_from_enu);
    view->plane_count = frame_planes(view->plane, &view->picture, request);
    return STATUS_OK;
}

/* Renders the frame once more without its target, or without any entity (publish.pairs). */
static Status look_without(Frame *f, const Session *s, const FrameLight *light, int host)
{
    const bool all = s->shared->config->publish.pairs == PUBLISH_PAIRS_ALL;
    f->without = arena_alloc(f->arena, 1, sizeof *f->without);
    if (!f->without) return STATUS_NO_MEMORY;
    *f->without->sha256 = 0;
    const PairsTaken take = {.all = all, .aim = s->plan.aim, .host = host};
    Status           status = pairs_take_away(f, &take);
    HeatScene       *heat = NULL;
    GroundMarks      marks;
    const World     *world = s->shared->world;
    if (status == STATUS_OK) /* the ground as it is where the target never stood */
        status = world_marks_at(&marks, world, &f->without->snapshot.marks, f->request.view.p_enu, f->unix_s, f->arena);
    if (status == STATUS_OK) status = world_heat_at(&heat, world, &marks, f->unix_s, f->arena);
    if (status != STATUS_OK) return status;
    FrameLight without = *light;
    without.air.heat = heat;
    return look(f->without, s, &f->request, &without, f->arena);
}

static bool eye_at(EyeState *out, void *of, double t_s)
{
    Eye        eye;
    const bool there = session_eye(&eye, of, NULL, t_s);
    if (there) *out = eye.state;
    return there;
}

static bool entity_at(SnapshotEntity *out, void *of, DisEntityId id, double t_s)
{
    const Session *s = of;
    return entity_table_pose(out, s->table, entity_table_find(s->table, id), t_s);
}

/* What the recording says of the instruments. */
static InstrumentNote noted_by(unsigned verdict)
{
    if (verdict & VERDICT_NO_RADAR) return INSTRUMENT_ABSENT;
    return verdict & VERDICT_COARSE_RADAR ? INSTRUMENT_COARSE : INSTRUMENT_NOT_NOTED;
}

/* What instruments lacked in this frame because it was not ready. */
static unsigned lacked(const Frame *f)
{
    unsigned verdict = 0;
    for (int i = 0; i < f->outputs; i++) {
        if (f->output[i].left_out && f->output[i].kind->noted) verdict |= VERDICT_NO_RADAR;
        if (f->output[i].coarse) verdict |= VERDICT_COARSE_RADAR;
    }
    return verdict;
}

/* Says in the record what the frame gave up. */
static Status give_up(Frame *f, Session *s, unsigned verdict)
{
    char *names = arena_alloc(f->arena, frame_verdict_names_size, 1);
    if (!names) return STATUS_NO_MEMORY;
    frame_verdict_names(names, verdict);
    if (*names) f->record.given_up = names;
    s->result.frames_reduced += f->record.given_up != NULL;
    return STATUS_OK;
}

/* Lets the instruments look. What one lacks by chance goes into the recording. */
static Status measure(Frame *f, Session *s, const Eye *eye, unsigned verdict)
{
    const InstrumentLook look = {
        .frame = f,
        .eye = &eye->state,
        .wants = s->wants,
        .aim = dis_entity_id_is_none(s->plan.aim) ? -1 : snapshot_find(&f->seen.snapshot, s->plan.aim),
        .aim_m = aim_range(eye),
        .noted = noted_by(verdict),
        .pool = s->shared->pool,
        .poses = {eye_at, entity_at, s}};
    const Status status = instruments_look(&s->instruments, &look);
    if (status != STATUS_OK) return status;
    instruments_count(s->result.instrument, f);
    const unsigned by_chance = look.noted ? 0 : lacked(f);
    note_verdict(s, by_chance, &(FrameTime){.number = f->number, .t_s = f->time_s});
    return give_up(f, s, verdict | by_chance);
}

/* Adds the targets and the error budget to the frame's record. */
static Status know_targets(Frame *f, const Session *s, const Eye *eye)
{
    const SessionShared *shared = s->shared;
    const FrameView     *seen = &f->seen;
    FrameRecord         *r = &f->record;
    Target              *target = arena_alloc(f->arena, (size_t)seen->snapshot.count, sizeof *target);
    if (!target) return STATUS_NO_MEMORY;
    r->target_count = truth_targets(target, &seen->picture, shared->world, &seen->snapshot, &f->request, &eye->state,
                                    camera_noise(f));
    if (s->wants & WANT_ERROR &&
        frame_error(&f->error,
                    &(FrameErrorOf){&seen->picture, shared->world, &seen->snapshot, &f->request,
                                    shared->config->models.sag_m, shared->contact == GROUND_CONTACT_ALL,
                                    world_air_k(shared->world, f->unix_s)},
                    target, r->target_count))
        r->error = &f->error;
    r->target = target_records(target, r->target_count, &seen->snapshot, shared->catalog, f->arena);
    if (!r->target) return STATUS_NO_MEMORY;
    const SceneryTracer *tracer = shared->world->scenery;
    const Status         status = clutter_records(&r->clutter, &r->clutter_count, &seen->picture,
                                          tracer ? scenery_tracer_of(tracer) : NULL, f->arena);
    if (status != STATUS_OK) return status;
    r->ground_km2 = 1e-6 * truth_ground_area(shared->world, &f->request);
    return STATUS_OK;
}

static void fill_record(Frame *f, const Session *s, const Eye *eye)
{
    FrameRecord *r = &f->record;
    *r = (FrameRecord){.frame = f->number,
                       .time_s = f->time_s,
                       .snapshot = &f->seen.snapshot,
                       .catalog = s->shared->catalog,
                       .host = eye->hidden >= 0 ? &f->seen.snapshot.entity[eye->hidden] : NULL,
                       .host_id = s->shared->flight ? s->shared->flight->id : (DisEntityId){0},
                       .request = &f->request,
                       .hfov_rad = eye->turned ? 2 * atan(0.5 * eye->view.width / eye->view.focal_px)
                                               : s->shared->config->sensor.hfov_deg * rad_per_deg,
                       .turned = eye->turned,
                       .head = eye->head,
                       .gimbal_at_limit = eye->at_limit,
                       .scene_rate_px_s = {f->rate_px_s[0], f->rate_px_s[1]},
                       .ground_km2 = NAN,
                       .sun = &f->sun};
    memcpy(r->p_eye_ecef, eye->state.p_ecef, sizeof r->p_eye_ecef);
    memcpy(r->v_eye_mps, eye->state.v_ecef_mps, sizeof r->v_eye_mps);
    memcpy(r->r_ecef_from_body, eye->r_ecef_from_body, sizeof r->r_ecef_from_body);
    memcpy(r->r_ecef_from_cam, eye->state.r_ecef_from_cam, sizeof r->r_ecef_from_cam);
}

/* Writes the frame as a frame file, if requested. */
static Status save_frame(const Session *s, const Frame *f, const Eye *eye)
{
    const SessionShared *shared = s->shared;
    for (int i = 0; i < shared->save_count; i++)
        if (shared->save[i] == f->number)
            return frame_save(&(FrameSave){f, shared->config, s->out, &eye->state, shared->unix_s,
                                           shared->contact == GROUND_CONTACT_ALL, shared->pool, shared->woods,
                                           shared->scenery});
    return STATUS_OK;
}

/* A building that an entity stands for is seen, and the entity's own model is not. */
static void take_over_buildings(Frame *f, const SessionShared *shared)
{
    Snapshot *s = &f->seen.snapshot;
    for (int i = 0; i < s->count && shared->scenery; i++) {
        SnapshotEntity *e = &s->entity[i];
        double          p_enu[3];
        if (e->type.kind != dis_kind_cultural_feature || e->model < 0) continue;
        enu_from_ecef(p_enu, &shared->world->frame, e->p_ecef);
        if (choice_building_of(&shared->scenery->culture, shared->catalog, e->type, e->model, p_enu) >= 0)
            e->model = -1;
    }
}

Status session_make_frame(bool *shown, int *left_out, Frame *f, Session *s, const FrameTime *when)
{
    const double         t_s = when->t_s;
    const SessionShared *shared = s->shared;
    Eye                  eye;
    *shown = false;
    f->provenance.begun_s = wall_clock_s();
    Status status = entity_table_snapshot(&f->seen.snapshot, s->table, t_s, f->arena);
    if (status == STATUS_OK && s->heat.vehicles)
        status = world_vehicles_show(s->heat.vehicles, &f->seen.snapshot, f->arena);
    if (status != STATUS_OK || !session_eye(&eye, s, &f->seen.snapshot, t_s)) return status;
    take_over_buildings(f, shared);
    f->times.posed_s = wall_clock_s();
    *left_out = f->seen.snapshot.left_out;
    f->number = when->number;
    f->time_s = t_s;
    f->unix_s = shared->unix_s + t_s;
    f->world = shared->world;
    memcpy(f->host, s->host_text, sizeof f->host);

    FrameLight     light = {0};
    const double  *p_ecef = eye.state.p_ecef;
    const FrameEye at = {
        f->unix_s, {p_ecef[0], p_ecef[1], p_ecef[2]}, &eye.view, shared->bands, &f->seen.snapshot.marks};
    status = frame_light(&light, shared->world, shared->config, &at, shared->pool, f->arena);
    f->sun = light.sun;
    make_request(&f->request, s, &eye, t_s);
    const unsigned verdict = judge(s, when);
    frame_verdict_apply(&f->request, verdict);
    const double posed_s = wall_clock_s();
    if (status == STATUS_OK) status = look(&f->seen, s, &f->request, &light, f->arena);
    if (status == STATUS_OK && s->wants & WANT_WITHOUT) status = look_without(f, s, &light, eye.hidden);
    if (status != STATUS_OK) return status;
    if (f->seen.picture.range_m) rate_of_scene(f->rate_px_s, &eye, &f->seen.picture);
    fill_record(f, s, &eye);
    if (s->wants & WANT_FOOTPRINT) {
        truth_footprint(f->footprint, shared->world, &f->request);
        f->record.footprint = f->footprint;
    }
    status = measure(f, s, &eye, verdict);
    if (status == STATUS_OK && s->wants & WANT_TARGETS) status = know_targets(f, s, &eye);
    if (status != STATUS_OK) return status;
    if (shared->world->landscape) {
        const double *p_enu = eye.view.p_enu;
        f->buried = p_enu[2] < elevation_height(&shared->world->landscape->elevation, p_enu[0], p_enu[1], NULL);
    }
    f->provenance = (Provenance){.version = PITVIPER_VERSION,
                                 .config_sha256 = shared->config_sha256,
                                 .seed = shared->config->seed,
                                 .datagrams = player_counters(s->player)->datagrams,
                                 .begun_s = f->provenance.begun_s,
                                 .posed_s = posed_s,
                                 .rendered_s = wall_clock_s()};
    f->times.render_s = posed_s;
    f->times.rendered_s = f->provenance.rendered_s;
    *shown = true;
    status = session_begin_files(s);
    return status == STATUS_OK ? save_frame(s, f, &eye) : status;
}
