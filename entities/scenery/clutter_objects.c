/* entities/scenery/clutter_objects.c: placed things as objects of a scenery, with the models and states that they need.
 */
#include "entities/scenery/scenery_clutter_private.h"

#include <stdlib.h>

/* Of what has stopped: what it did until then. */
static EntityDrives drives_of(int mode)
{
    /* cruising takes a civil vehicle a sixth of its full power; of that the gas of its engine is to be as warm, between
     * idling (0.6) and full power; estimate */
    static const double cruises = 0.75;
    /* under load: 0.43 of the power of generators, 0.59 of that of tractors, dozers, excavators and fork lifts (US EPA
     * NR-005d, Median Life, Annual Activity, and Load Factor Values, 2010, typed from knowledge), between idling and
     * full power */
    static const double works = 0.82;
    static const double climbs = 0.85; /* over soil: rolling resistance of 9 %, 100 of 240 kW at 20 km/h */
    EntityDrives        drives = {0};
    if (mode == clutter_mode_idles) drives.engine = (float)drives_idle;
    else if (mode == clutter_mode_works) drives.engine = (float)works;
    else if (mode == clutter_mode_lives) drives.alive = 1;
    else if (mode == clutter_mode_burns) drives.burning = 1;
    else if (mode >= clutter_mode_stopped) drives.engine = (float)cruises;
    else if (mode >= clutter_mode_drives) {
        drives.engine = (float)(mode - clutter_mode_drives == clutter_off_ways ? climbs : cruises);
        drives.speed_mps = (float)clutter_speed_mps[mode - clutter_mode_drives];
    }
    return drives;
}

static double stood_s_of(int mode)
{
    if (mode < clutter_mode_stopped) return 0;
    return clutter_stop_least_s *
           pow(clutter_stop_most_s / clutter_stop_least_s, (mode - clutter_mode_stopped + 0.5) / clutter_stops);
}

enum { most_ruts = 1 << 18 };

/* How finely states are told apart: clutter_headings and clutter_stops, or fewer. */
typedef struct Grain {
    int headings, stops;
} Grain;

/* What is added, before it is. */
typedef struct Added {
    Scenery scenery;
    Grain   grain;
    int    *state_of; /* [variants][clutter_modes][clutter_headings]; -1: none yet */
    int    *path_of;  /* [paths] */
    int     rut_room; /* of scenery.rut */
} Added;

/* The mode that stands for a mode: of several steps of time the middle one. */
static int coarse_mode(int mode, Grain grain)
{
    if (mode < clutter_mode_stopped) return mode;
    const int each = clutter_stops / grain.stops, step = mode - clutter_mode_stopped;
    return clutter_mode_stopped + step / each * each + each / 2;
}

static int coarse_heading(double heading_rad, Grain grain)
{
    const int turn = (int)lrint(heading_rad / (2 * pi_rad) * grain.headings) % grain.headings;
    return (turn + grain.headings) % grain.headings * (clutter_headings / grain.headings);
}

static int *state_at(const Added *a, const ClutterWork *work, const ClutterThing *t)
{
    return &a->state_of[(work->variant[t->variant].same * clutter_modes + coarse_mode(t->mode, a->grain)) *
                            clutter_headings +
                        coarse_heading(t->heading_rad, a->grain)];
}

/* The finest grain by which all things need no more states than are allowed. */
static Grain choose_grain(Added *a, const ClutterWork *work, size_t room)
{
    static const Grain grains[] = {
        {clutter_headings, clutter_stops}, {8, clutter_stops}, {4, clutter_stops}, {4, 3}, {2, 3}, {1, 3}, {1, 1}};
    for (size_t g = 0;; g++) {
        int states = 0;
        a->grain = grains[g];
        memset(a->state_of, 0, room * sizeof *a->state_of);
        for (int n = 0; n < work->things; n++) {
            int *at = state_at(a, work, &work->thing[n]);
            states += !*at, *at = 1;
        }
        memset(a->state_of, -1, room * sizeof *a->state_of);
        if (states <= work->config->most_states || g + 1 == sizeof grains / sizeof *grains) return grains[g];
    }
}

static Status add_thing(Added *a, ClutterWork *work, const ClutterThing *t)
{
    Scenery        *s = &a->scenery;
    ClutterVariant *v = &work->variant[work->variant[t->variant].same];
    Status          status = STATUS_OK;
    if (*state_at(a, work, t) < 0 && s->states == work->config->most_states) {
        work->left_out++;
        return STATUS_OK;
    }
    SceneryObject o = {.id = t->rank, .kind = SCENERY_CLUTTER, .class = (uint8_t)work->table.row[t->row].class};
    if (!clutter_pose(o.p_enu, o.r_enu_from_body, work->config->landscape, t->x_m, t->y_m, t->heading_rad, v->size_m,
                      t->mode == clutter_mode_lives || t->mode == clutter_mode_burns))
        return STATUS_OK;
    if (v->model < 0) {
        status = clutter_build_variant(&s->model[s->models], v, work->config->sag_m);
        if (status != STATUS_OK) return status;
        v->model = s->models++;
    }
    int *state = state_at(a, work, t);
    if (*state < 0) {
        const int mode = coarse_mode(t->mode, a->grain), heading = coarse_heading(t->heading_rad, a->grain);
        *state = s->states;
        s->state[s->states++] = (SceneryState){.model = v->model,
                                               .drives = drives_of(mode),
                                               .heading_rad = (float)(2 * pi_rad * heading / clutter_headings),
                                               .stood_s = (float)stood_s_of(mode)};
    }
    o.model = v->model, o.state = *state;
    if (t->path_count) {
        if (a->path_of[t->path] < 0) {
            a->path_of[t->path] = s->paths;
            memcpy(s->path_enu + s->paths, work->path + t->path, (size_t)t->path_count * sizeof *s->path_enu);
            memcpy(s->path_loose + s->paths, work->path_loose + t->path, (size_t)t->path_count);
            s->paths += t->path_count;
        }
        const SceneryMover mover = {s->objects, a->path_of[t->path], t->path_count, (double)t->speed_mps,
                                    (double)t->phase_m};
        scenery_pose(o.p_enu, o.r_enu_from_body, s, &mover, 0);
        s->mover[s->movers++] = mover;
    }
    s->ruts += clutter_ruts_of(s->rut + s->ruts, a->rut_room - s->ruts, work, t, s->objects);
    s->object[s->objects++] = o;
    return STATUS_OK;
}

static bool grow(void *array, int count, int more, size_t size)
{
    void *at;
    memcpy(&at, array, sizeof at);
    at = realloc(at, ((size_t)count + (size_t)more + 1) * size);
    if (at) memcpy(array, &at, sizeof at);
    return at;
}

/* Appends all of one scenery, whose numbers begin at 0, to another. Nothing can fail once there is memory. */
static Status join(Scenery *to, Scenery *from)
{
    if (!grow(&to->model, to->models, from->models, sizeof *to->model) ||
        !grow(&to->object, to->objects, from->objects, sizeof *to->object) ||
        !grow(&to->state, to->states, from->states, sizeof *to->state) ||
        !grow(&to->mover, to->movers, from->movers, sizeof *to->mover) ||
        !grow(&to->path_enu, to->paths, from->paths, sizeof *to->path_enu) ||
        !grow(&to->path_loose, to->paths, from->paths, sizeof *to->path_loose) ||
        !grow(&to->rut, to->ruts, from->ruts, sizeof *to->rut))
        return STATUS_NO_MEMORY;
    const bool fresh = !to->part_first;
    if (!grow(&to->part_first, to->models, from->models, sizeof *to->part_first)) return STATUS_NO_MEMORY;
    for (int k = 0; fresh && k < to->models; k++) to->part_first[k] = -1;
    for (int k = 0; k < from->models; k++) {
        to->model[to->models + k] = from->model[k];
        to->part_first[to->models + k] = -1;
    }
    for (int k = 0; k < from->objects; k++) {
        SceneryObject *o = &to->object[to->objects + k];
        *o = from->object[k], o->model += to->models, o->state += to->states;
    }
    for (int k = 0; k < from->states; k++)
        to->state[to->states + k] = from->state[k], to->state[to->states + k].model += to->models;
    for (int k = 0; k < from->movers; k++) {
        SceneryMover *m = &to->mover[to->movers + k];
        *m = from->mover[k], m->object += to->objects, m->first += to->paths;
    }
    for (int k = 0; k < from->ruts; k++)
        to->rut[to->ruts + k] = from->rut[k], to->rut[to->ruts + k].object += to->objects;
    if (from->paths) memcpy(to->path_enu + to->paths, from->path_enu, (size_t)from->paths * sizeof *to->path_enu);
    if (from->paths) memcpy(to->path_loose + to->paths, from->path_loose, (size_t)from->paths);
    to->models += from->models, to->objects += from->objects, to->states += from->states;
    to->movers += from->movers, to->paths += from->paths, to->ruts += from->ruts;
    from->models = 0;
    return STATUS_OK;
}

Status clutter_into_scenery(Scenery *scenery, ClutterWork *work)
{
    Added        a = {0};
    Status       status = STATUS_OK;
    const size_t things = (size_t)work->things + 1;
    const size_t states = (size_t)work->variants * clutter_modes * clutter_headings + 1;
    a.scenery.model = calloc((size_t)work->variants + 1, sizeof *a.scenery.model);
    a.scenery.object = calloc(things, sizeof *a.scenery.object);
    a.scenery.state = calloc(states, sizeof *a.scenery.state);
    a.scenery.mover = calloc(things, sizeof *a.scenery.mover);
    a.scenery.path_enu = calloc((size_t)work->paths + 1, sizeof *a.scenery.path_enu);
    a.scenery.path_loose = calloc((size_t)work->paths + 1, 1);
    a.rut_room = work->things < most_ruts / clutter_ruts_each ? work->things * clutter_ruts_each : most_ruts;
    a.scenery.rut = calloc((size_t)a.rut_room + 1, sizeof *a.scenery.rut);
    a.state_of = malloc(states * sizeof *a.state_of);
    a.path_of = malloc(((size_t)work->paths + 1) * sizeof *a.path_of);
    if (!a.scenery.model || !a.scenery.object || !a.scenery.state || !a.scenery.mover || !a.scenery.path_enu ||
        !a.scenery.path_loose || !a.scenery.rut || !a.state_of || !a.path_of)
        status = STATUS_NO_MEMORY;
    else {
        a.grain = choose_grain(&a, work, states);
        memset(a.path_of, -1, ((size_t)work->paths + 1) * sizeof *a.path_of);
        for (int n = 0; n < work->things && status == STATUS_OK; n++) status = add_thing(&a, work, &work->thing[n]);
        if (status == STATUS_OK) status = join(scenery, &a.scenery);
        if (status == STATUS_OK && work->left_out)
            log_warn(
                "clutter: some left out, which need more states than are solved: objects=%d states=%d; next: fewer "
                "shapes and paints in the table of clutter",
                work->left_out, work->config->most_states);
    }
    scenery_free(&a.scenery);
    free(a.state_of), free(a.path_of);
    return status;
}
