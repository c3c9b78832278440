/* etc/fmu/pitviper_seeker.c: the seeker as an FMU (FMI 3.0, co-simulation): pose in; line of sight and the frame's
 * place in shared memory out.
 *
 *     cc -O2 -fPIC -shared -fvisibility=hidden -I etc/include etc/fmu/pitviper_seeker.c -o pitviper_seeker.so -lm
 * -pthread
 *
 * fmi3ExitInitializationMode starts `pitviper replay RECORDING` (or `run`) with this instance as its CIGI host, and
 * waits for its world. fmi3DoStep asks for the frame at the beginning of the step, with the inputs of that time, and
 * returns when it is there. The program ends with the instance. Described in etc/reference/fmu.md and
 * modelDescription.xml. */
#include "pitviper_memory.h"

#include "child.h"
#include "fmi3.h"
#include "host.h"
#include "refused.h"
#include "variables.h"

#include <stdarg.h>

#define TOKEN "{6f0c2a53-9a1e-4a52-8a5b-2f3f7d1c9e10}"

typedef enum Phase { instantiated, initializing, stepping, ended } Phase;

typedef struct Seeker {
    char            name[64];
    fmi3Environment environment;
    fmi3LogMessage *log;
    bool            logs;
    Phase           phase;
    Values          v;
    Child           child;
    Host            host;
    PitviperMemory  frames;
    bool            frames_open, pending; /* pending: a frame was asked for, and is not there yet */
    char            ring_name[100];
    double          begun_s, last_s; /* FMI's time at the start; of the last frame that was asked for, -INFINITY */
    int64_t         ticks;           /* of that frame */
} Seeker;

static fmi3Status say(const Seeker *s, fmi3Status status, const char *form, ...)
{
    char    text[4096];
    va_list list;
    va_start(list, form);
    vsnprintf(text, sizeof text, form, list);
    va_end(list);
    if (s->log && (s->logs || status >= fmi3Discard))
        s->log(s->environment, status, status >= fmi3Discard ? "error" : "info", text);
    return status;
}

/* ---- the program -------------------------------------------------------------------------------- */

enum { arguments_most = 256 };

typedef struct Arguments {
    char  *at[arguments_most];
    int    count;
    char   text[2 * text_size];
    size_t used;
    bool   full;
} Arguments;

static void add(Arguments *a, const char *form, ...)
{
    va_list list;
    va_start(list, form);
    const int length = vsnprintf(a->text + a->used, sizeof a->text - a->used, form, list);
    va_end(list);
    a->full |= length >= (int)(sizeof a->text - a->used) || a->count + 1 >= arguments_most;
    if (a->full) return;
    a->at[a->count++] = a->text + a->used;
    a->used += (size_t)length + 1;
}

/* Words of the parameter `options`: separated by spaces; '...' is one word. */
static void add_words(Arguments *a, const char *text)
{
    for (;;) {
        text += strspn(text, " \t\n");
        if (!*text) return;
        const bool   quoted = *text == '\'';
        const size_t length = strcspn(text += quoted, quoted ? "'" : " \t\n");
        add(a, "%.*s", (int)length, text);
        text += length + (quoted && text[length]);
    }
}

/* over: the program has ended. */
static void stop(Seeker *s, bool over)
{
    char path[160];
    if (s->frames_open) pitviper_memory_close(&s->frames);
    child_stop(&s->child, over);
    host_close(&s->host);
    if (*s->ring_name && snprintf(path, sizeof path, PITVIPER_MEMORY_FOLDER "/%s", s->ring_name) < (int)sizeof path)
        unlink(path); /* of a program that was killed */
    *s->ring_name = 0;
    s->frames_open = s->pending = false;
    s->phase = ended;
}

static fmi3Status start(Seeker *s)
{
    const char *of = s->v.text[memory - program], *out = s->v.text[folder - program];
    const char *log = s->v.text[recording - program];
    Arguments   a = {.count = 0};
    char        path[text_size];
    if (!child_find(path, sizeof path, s->v.text[0]))
        return say(s, fmi3Error, "%s is not a program that can be started: parameter `program`", s->v.text[0]);
    if (!host_open(&s->host)) return say(s, fmi3Error, "no UDP socket: %s", strerror(errno));
    if (*of) snprintf(s->ring_name, sizeof s->ring_name, "%.90s", of);
    else snprintf(s->ring_name, sizeof s->ring_name, "pitviper-fmu-%ld-%u", (long)getpid(), s->host.own_port);
    add(&a, "%s", path);
    add(&a, *log ? "replay" : "run");
    if (*log) add(&a, "%s", log);
    add(&a, "--cigi"), add(&a, "127.0.0.1:%u", s->host.own_port);
    add(&a, "--set"), add(&a, "exercise.cigi_port=%u", s->host.ig_port);
    add(&a, "--memory"), add(&a, "%s", s->ring_name);
    add(&a, "--set"), add(&a, "publish.memory_record=truth");
    if (*s->v.text[target - program]) add(&a, "--set"), add(&a, "exercise.aim=%s", s->v.text[target - program]);
    add(&a, "--out"), add(&a, *out ? "%s" : "pitviper-%s", *out ? out : s->name);
    if (!*out) add(&a, "--overwrite");
    add_words(&a, s->v.text[options - program]);
    if (a.full) return say(s, fmi3Error, "parameter `options` has too many words");
    if (!child_start(&s->child, a.at, s->v.text[log_file - program]))
        return say(s, fmi3Error, "cannot start %s: %s", path, strerror(errno));
    return say(s, fmi3OK, "started %s", path);
}

/* ---- the frame ---------------------------------------------------------------------------------- */

/* Waits until Start of Frame comes. fmi3Discard: not within limit_s. fmi3Error: the program has ended, *code by its
 * status. */
static fmi3Status await(Seeker *s, double limit_s, int *code)
{
    const int64_t until_ns = pitviper_memory_now_ns() + (int64_t)(1e9 * fmin(fmax(limit_s, 0), 1e6));
    char          how[64], words[1500];
    *code = -1;
    while (!host_hear(&s->host)) {
        const int64_t left_ns = until_ns - pitviper_memory_now_ns();
        if (child_has_ended(how, sizeof how, code, &s->child)) {
            child_last_words(words, sizeof words, &s->child);
            stop(s, true);
            if (*code == 0) return fmi3Error;
            return say(s, fmi3Error, "pitviper ended %s; its last words:\n%s", how, words);
        }
        if (left_ns <= 0) return fmi3Discard;
        struct pollfd what[2] = {{s->host.socket, POLLIN, 0}, {s->child.ended[0], POLLIN, 0}};
        poll(what, 2, left_ns < 200000000 ? (int)(left_ns / 1000000) + 1 : 200);
    }
    return fmi3OK;
}

/* Of the eye's inputs: attitude as a quaternion, which is brought to length 1. */
static bool eye_of(HostEye *eye, const double in[])
{
    const double *q = in + attitude;
    const double  length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 1e-6 && length < 1e6)) return false;
    const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(eye->r_ecef_from_eye, r, sizeof r);
    memcpy(eye->p_ecef, in + position, sizeof eye->p_ecef);
    memcpy(eye->v_ecef_mps, in + velocity, sizeof eye->v_ecef_mps);
    memcpy(eye->w_eye_rps, in + turning, sizeof eye->w_eye_rps);
    eye->rates = in[rates] != 0;
    for (int i = 0; i < 3; i++)
        if (!(fabs(eye->v_ecef_mps[i]) < 1e5 && fabs(eye->w_eye_rps[i]) < 1e4)) return false;
    return true;
}

/* The line of sight to a target of the frame, whose azimuth and elevation are in the axes of the eye's place. */
static void show_target(double out[], const PitviperMemoryRecord *r, const PitviperMemoryTarget *t)
{
    double       lat, lon, height_m, ned[9], d_ecef[3], d_cam[3] = {0, 0, 0};
    const double ce = cos(t->los_el_rad),
                 d_ned[3] = {ce * cos(t->los_az_rad), ce * sin(t->los_az_rad), -sin(t->los_el_rad)};
    if (!host_geodetic(&lat, &lon, &height_m, ned, r->p_ecef)) return;
    for (int i = 0; i < 3; i++)
        d_ecef[i] = ned[3 * i] * d_ned[0] + ned[3 * i + 1] * d_ned[1] + ned[3 * i + 2] * d_ned[2];
    for (int i = 0; i < 9; i++) d_cam[i % 3] += r->r_ecef_from_cam[i] * d_ecef[i / 3];
    memcpy(out + sight, d_ecef, sizeof d_ecef);
    memcpy(out + sight_rate, t->los_rate_rps, sizeof t->los_rate_rps);
    out[range_m] = t->range_m, out[closing_mps] = t->closing_mps;
    out[right_rad] = atan2(d_cam[0], d_cam[2]);
    out[up_rad] = atan2(-d_cam[1], hypot(d_cam[0], d_cam[2]));
    out[visible] = t->visible_fraction, out[pixels] = t->pixels;
    out[valid] = t->pixels > 0;
}

static double off_axis(const PitviperMemoryTarget *t)
{
    return hypot(t->boresight_error_rad[0], t->boresight_error_rad[1]);
}

/* The frame of exercise time wanted_s, if it was made. */
static void show_frame(Seeker *s, double wanted_s)
{
    static const double  near_s = 1e-6;
    double              *out = s->v.number;
    char                 id[32];
    int                  best = -1;
    PitviperMemoryTarget t, chosen = {0};
    for (int i = valid; i < variables; i++) out[i] = 0;
    out[frame] = -1;
    if (!s->frames_open) s->frames_open = pitviper_memory_open(&s->frames, s->ring_name) == 0;
    if (!s->frames_open || pitviper_memory_take_newest(&s->frames) != 1) return;
    const PitviperMemoryRecord *r = &s->frames.record;
    if (fabs(r->time_s - wanted_s) > near_s && *s->v.text[recording - program]) return;
    const PitviperMemoryHeader *h = &s->frames.header;
    out[frame_s] = r->time_s, out[frame] = r->frame, out[sequence] = (double)r->sequence;
    out[offset] = (double)(h->slot_offset + (r->sequence - 1) % h->slot_count * h->slot_size);
    out[octets] = (double)h->slot_size;
    const char *named = s->v.text[target - program];
    for (uint32_t i = 0; pitviper_memory_target(&t, &s->frames, i); i++) {
        snprintf(id, sizeof id, "%u:%u:%u", t.site, t.application, t.entity);
        if (*named ? strcmp(id, named) != 0 : best >= 0 && !(off_axis(&t) < off_axis(&chosen))) continue;
        chosen = t;
        best = (int)i;
    }
    if (best >= 0) show_target(out, r, &chosen);
}

/* ---- life --------------------------------------------------------------------------------------- */

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, bool seen,
                                         bool logging, bool event_mode, bool early_return,
                                         const fmi3Reference required[], size_t required_count,
                                         fmi3Environment environment, fmi3LogMessage *log, fmi3Callback *intermediate)
{
    Seeker unborn = {.environment = environment, .log = log};
    (void)resources, (void)seen, (void)event_mode, (void)early_return, (void)required, (void)required_count;
    (void)intermediate;
    if (!token || strcmp(token, TOKEN) != 0)
        return say(&unborn, fmi3Error, "the library is not that of the model description: instantiationToken"), NULL;
    Seeker *const s = calloc(1, sizeof *s);
    if (!s) return say(&unborn, fmi3Error, "out of memory"), NULL;
    snprintf(s->name, sizeof s->name, "%s", name ? name : "");
    for (char *c = s->name; *c; c++) /* it names a folder */
        if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_", *c)) *c = '_';
    s->environment = environment, s->log = log, s->logs = logging;
    s->host.socket = -1;
    set_start_values(&s->v);
    return s;
}

void fmi3FreeInstance(fmi3Instance of)
{
    if (!of) return;
    stop(of, false);
    free(of);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance of, bool on, size_t count, const fmi3String categories[])
{
    (void)count, (void)categories;
    if (!of) return fmi3Error;
    ((Seeker *)of)->logs = on;
    return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance of, bool tolerance_defined, double tolerance, double from_s,
                                       bool stop_defined, double to_s)
{
    Seeker *const s = of;
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)to_s;
    if (!s || s->phase != instantiated) return fmi3Error;
    if (!isfinite(from_s)) return say(s, fmi3Error, "the start time is no number");
    s->begun_s = s->v.number[time_s] = from_s;
    s->last_s = -INFINITY;
    s->phase = initializing;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance of)
{
    Seeker *const s = of;
    int           code;
    if (!s || s->phase != initializing) return fmi3Error;
    fmi3Status status = start(s);
    if (status == fmi3OK) status = await(s, s->v.number[start_limit_s], &code);
    if (status == fmi3Discard)
        say(s, fmi3Error, "the world is not made within %g s: parameter `start_limit_s`", s->v.number[start_limit_s]);
    if (status == fmi3OK) s->phase = stepping;
    else stop(s, false);
    return status == fmi3OK ? fmi3OK : fmi3Error;
}

fmi3Status fmi3Terminate(fmi3Instance of)
{
    if (!of) return fmi3Error;
    stop(of, false);
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance of)
{
    Seeker *const s = of;
    if (!s) return fmi3Error;
    stop(s, false);
    set_start_values(&s->v);
    s->phase = instantiated;
    return fmi3OK;
}

/* Asks for the frame at FMI's time at_s, unless it is that which is awaited already. */
static fmi3Status ask(Seeker *s, double at_s)
{
    static const double ticks_per_s = 1e5;
    HostEye             eye;
    const double        exercise_s = s->v.number[start_s] + at_s - s->begun_s;
    if (!(exercise_s >= 0 && exercise_s < 1e9))
        return say(s, fmi3Error, "exercise time %g s is out of range: parameter `start_s`", exercise_s);
    if (s->last_s == -INFINITY && exercise_s * ticks_per_s > UINT32_MAX)
        return say(s, fmi3Error, "the first frame is later than 11.9 h, where a host's time begins again");
    if (!eye_of(&eye, s->v.number)) return say(s, fmi3Error, "the eye's attitude or rates are no numbers, or 0");
    const int64_t ticks = llround(exercise_s * ticks_per_s);
    if (!host_ask(&s->host, 0, &eye, (uint32_t)ticks))
        return say(s, fmi3Error, "the eye's position is not near Earth: position_x, _y, _z");
    s->ticks = ticks, s->last_s = at_s;
    s->pending = true;
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance of, double at_s, double step_s, bool no_state_before, bool *event, bool *terminate,
                      bool *early, double *last_s)
{
    Seeker *const s = of;
    fmi3Status    status = fmi3OK;
    int           code = -1;
    (void)no_state_before;
    if (!s || !event || !terminate || !early || !last_s) return fmi3Error;
    *event = *terminate = *early = false;
    *last_s = at_s;
    if (s->phase != stepping) return say(s, fmi3Error, "fmi3DoStep before initialization, or after the end");
    if (!isfinite(at_s) || !(step_s > 0 && isfinite(step_s))) return say(s, fmi3Error, "a time that is no number");
    if (at_s < s->last_s) return say(s, fmi3Error, "time goes back, from %g to %g s", s->last_s, at_s);
    if (s->pending && at_s > s->last_s) { /* one that was given up */
        status = await(s, s->v.number[step_limit_s], &code);
        s->pending = status != fmi3OK;
    }
    if (status == fmi3OK && !s->pending) status = ask(s, at_s);
    if (s->pending && status == fmi3OK) status = await(s, s->v.number[step_limit_s], &code);
    if (s->phase == ended && code == 0) {
        *terminate = true; /* the program has ended as it was told: its exercise.to_s is past */
        return say(s, fmi3OK, "the exercise is over");
    }
    if (status == fmi3Discard)
        return say(s, status, "no frame within %g s: parameter `step_limit_s`; the same step can be tried again",
                   s->v.number[step_limit_s]);
    if (status != fmi3OK) return status;
    s->pending = false;
    show_frame(s, (double)s->ticks / 1e5);
    *last_s = s->v.number[time_s] = at_s + step_s;
    return fmi3OK;
}

/* ---- values ------------------------------------------------------------------------------------- */

static bool good(const Seeker *s, const fmi3Reference reference[], size_t count, const void *value, size_t value_count,
                 int kind, int other)
{
    if (!s || count != value_count || (count && (!reference || !value))) return false;
    for (size_t i = 0; i < count; i++)
        if (kind_of(reference[i]) != kind && kind_of(reference[i]) != other) return false;
    return true;
}

/* Parameters before the start, inputs always. */
static bool settable(const Seeker *s, const fmi3Reference reference[], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const bool input = reference[i] >= position && reference[i] < turning + 3;
        if (reference[i] == time_s || reference[i] >= valid ||
            (!input && s->phase != instantiated && s->phase != initializing))
            return false;
    }
    return true;
}

#define VALUES(Name, type, kind, other)                                                                                \
    fmi3Status fmi3Get##Name(fmi3Instance s, const fmi3Reference reference[], size_t count, type value[],              \
                             size_t value_count)                                                                       \
    {                                                                                                                  \
        if (!good(s, reference, count, value, value_count, kind, other)) return fmi3Error;                             \
        for (size_t i = 0; i < count; i++) value[i] = (type)((Seeker *)s)->v.number[reference[i]];                     \
        return fmi3OK;                                                                                                 \
    }                                                                                                                  \
    fmi3Status fmi3Set##Name(fmi3Instance s, const fmi3Reference reference[], size_t count, const type value[],        \
                             size_t value_count)                                                                       \
    {                                                                                                                  \
        if (!good(s, reference, count, value, value_count, kind, other) || !settable(s, reference, count))             \
            return fmi3Error;                                                                                          \
        for (size_t i = 0; i < count; i++) ((Seeker *)s)->v.number[reference[i]] = (double)value[i];                   \
        return fmi3OK;                                                                                                 \
    }
enum { none_is = -2 };
VALUES(Float32, float, none_is, none_is)
VALUES(Float64, double, is_number, is_time)
VALUES(Int8, int8_t, none_is, none_is)
VALUES(UInt8, uint8_t, none_is, none_is)
VALUES(Int16, int16_t, none_is, none_is)
VALUES(UInt16, uint16_t, none_is, none_is)
VALUES(Int32, int32_t, none_is, none_is)
VALUES(UInt32, uint32_t, none_is, none_is)
VALUES(Int64, int64_t, is_count, none_is)
VALUES(UInt64, uint64_t, none_is, none_is)
VALUES(Boolean, bool, is_flag, none_is)

fmi3Status fmi3GetString(fmi3Instance of, const fmi3Reference reference[], size_t count, fmi3String value[],
                         size_t value_count)
{
    Seeker *const s = of;
    if (!good(s, reference, count, value, value_count, is_text, none_is)) return fmi3Error;
    for (size_t i = 0; i < count; i++)
        value[i] = reference[i] == ring ? s->ring_name : s->v.text[reference[i] - program];
    return fmi3OK;
}

fmi3Status fmi3SetString(fmi3Instance of, const fmi3Reference reference[], size_t count, const fmi3String value[],
                         size_t value_count)
{
    Seeker *const s = of;
    if (!good(s, reference, count, value, value_count, is_text, none_is) || !settable(s, reference, count))
        return fmi3Error;
    for (size_t i = 0; i < count; i++) {
        if (!value[i] || strlen(value[i]) >= text_size) return say(s, fmi3Error, "a text of more than 4095 octets");
        strcpy(s->v.text[reference[i] - program], value[i]);
    }
    return fmi3OK;
}

/* ---- what there is not ---------------------------------------------------------------------------- */

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, bool seen,
                                          bool logging, fmi3Environment environment, fmi3LogMessage *log)
{
    (void)name, (void)token, (void)resources, (void)seen, (void)logging, (void)environment, (void)log;
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, bool seen,
                                               bool logging, fmi3Environment environment, fmi3LogMessage *log,
                                               fmi3Callback *clock, fmi3Callback *lock, fmi3Callback *unlock)
{
    (void)name, (void)token, (void)resources, (void)seen, (void)logging, (void)environment, (void)log;
    (void)clock, (void)lock, (void)unlock;
    return NULL;
}
