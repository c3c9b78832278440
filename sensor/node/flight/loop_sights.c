/* sensor/node/flight/loop_sights.c: from answers to lines of sight: which detection, through which camera, from when
 * on; and the recording of them by which a flight is flown again. */
#include "sensor/node/flight/flight_loop.h"

#include "pitviper_output.h"
#include "pitviper_table.h"

#include <errno.h>
#include <stdlib.h>
#include <time.h>

const char *const loop_verdict_name[loop_verdict_count] = {"seen", "empty", "outside", "none"};

/* A detection further than this from where the target is expected, in widths of the image, is another's. */
static const double gate_widths = 1.0 / 6;
/* The last line of sight is carried on so long; then the boresight is where the target is expected. */
static const double carried_s = 1;

/* ---- the thread that receives answers ------------------------------------------------------------- */

static bool point_of(double px[2], const AnswerDetection *d)
{
    const bool boxed = !isnan(d->box_px[0]);
    for (int k = 0; k < 2; k++) px[k] = boxed ? 0.5 * (d->box_px[k] + d->box_px[k + 2]) : d->point_px[k];
    return isfinite(px[0]) && isfinite(px[1]);
}

/* Where among the waiting frames one is; -1: it is none of them. The lock must be held. */
static int waiting_at(const FlightLoop *l, int frame)
{
    for (int i = 0; i < l->count; i++) {
        const int at = (l->first + i) % loop_waiting_most;
        if (l->waiting[at].number == frame) return at;
    }
    return -1;
}

/* The first answer to a frame counts, whatever its band. One to a frame that is not waited for takes no other's place.
 */
void loop_sights_taken(void *user, const Answer *answer)
{
    FlightLoop *l = user;
    if (l->source != LOOP_ANSWERS) return;
    pthread_mutex_lock(&l->lock);
    const int   at = waiting_at(l, answer->frame);
    LoopAnswer *in = at < 0 ? NULL : &l->inbox[at];
    if (!in && answer->frame <= l->settled) l->late++;
    else if (!in) l->unasked++;
    if (in && !in->there) {
        *in = (LoopAnswer){.there = true};
        for (int i = 0; i < answer->count; i++)
            if (point_of(in->px[in->count], &answer->detection[i])) in->score[in->count++] = answer->detection[i].score;
        pthread_cond_signal(&l->arrived);
    }
    pthread_mutex_unlock(&l->lock);
}

/* The answer to the frame that waits at a place. The lock must be held. */
static const LoopAnswer *answer_at(const FlightLoop *l, int at) { return l->inbox[at].there ? &l->inbox[at] : NULL; }

/* ---- lines of sight --------------------------------------------------------------------------------- */

static void through(double d_ecef[3], const LoopCamera *c, const double px[2])
{
    double d_cam[3];
    View   view = c->view;
    m3_identity(view.r_enu_from_cam);
    view_ray(d_cam, &view, px[0], px[1]);
    m3_mul_v3(d_ecef, c->r_ecef_from_cam, d_cam);
}

/* Where the target is expected in a frame: as the filter has it, else along the boresight. */
static void expected(double d_ecef[3], const FlightLoop *l, const LoopCamera *c)
{
    const SightFilter *f = &l->filter;
    const double       age_s = c->t_s - f->t_s;
    if (f->count > 0 && age_s <= carried_s) {
        v3_add_scaled(d_ecef, f->los_ecef, f->count > 1 ? age_s : 0, f->rate_ecef_rps);
        if (v3_normalize(d_ecef, d_ecef)) return;
    }
    for (int k = 0; k < 3; k++) d_ecef[k] = c->r_ecef_from_cam[3 * k + 2];
}

/* The detection nearest to where the target is expected. */
static LoopVerdict choose(double px[2], const FlightLoop *l, const LoopCamera *c, const LoopAnswer *a)
{
    double nearest = cos(atan(gate_widths * c->view.width / c->view.focal_px)), d[3], at[3];
    int    found = -1;
    if (a->count == 0) return LOOP_EMPTY;
    expected(d, l, c);
    for (int i = 0; i < a->count; i++) {
        through(at, c, a->px[i]);
        const double along = v3_dot(at, d);
        if (!(along >= nearest)) continue;
        nearest = along;
        found = i;
    }
    if (found < 0) return LOOP_OUTSIDE;
    px[0] = a->px[found][0], px[1] = a->px[found][1];
    return LOOP_SEEN;
}

void loop_push(FlightLoop *l, const LoopUsable *usable)
{
    l->usable[l->usable_count++ % loop_waiting_most] = *usable;
    if (l->hooks && l->hooks->sight) l->hooks->sight(l->hooks->user, usable);
}

static void push(FlightLoop *l, const FlightSight *sight)
{
    loop_push(l, &(LoopUsable){fmax(sight->t_s + l->late_s, l->least_from_s), *sight});
}

const FlightSight *loop_sights_at(const FlightLoop *l, double t_s)
{
    for (int64_t k = l->usable_count - 1; k >= 0 && k >= l->usable_count - loop_waiting_most; k--) {
        const LoopUsable *u = &l->usable[k % loop_waiting_most];
        if (u->from_s <= t_s + 1e-9) return &u->sight;
    }
    return NULL;
}

/* A place in the image as a line of sight, whose rate the filter makes. */
static void guide(FlightLoop *l, const LoopCamera *c, const double px[2])
{
    double      los[3];
    FlightSight sight;
    through(los, c, px);
    if (!sight_filter_take(&l->filter, c->t_s, los)) return;
    sight_filter_sight(&sight, &l->filter, c->p_ecef, c->v_ecef_mps);
    push(l, &sight);
}

bool loop_sights_direct(FlightLoop *l, const double los_ecef[3], double range_m, double closing_mps)
{
    FlightSight sight;
    if (!sight_filter_take(&l->filter, l->eye.t_s, los_ecef)) return false;
    sight_filter_sight(&sight, &l->filter, l->eye.p_ecef, l->eye.v_ecef_mps);
    if (isfinite(range_m) && isfinite(closing_mps)) sight.range_m = range_m, sight.closing_mps = closing_mps;
    push(l, &sight);
    return true;
}

static void guide_truly(FlightLoop *l, const LoopCamera *c)
{
    static const double unknown[3] = {NAN, NAN, NAN};
    FlightSight         sight;
    if (c->target_known &&
        flight_sight_true(&sight, c->t_s, c->p_ecef, c->v_ecef_mps, c->target_ecef, c->target_v_ecef_mps, unknown))
        push(l, &sight);
}

void loop_sights_say_refused(const FlightLoop *l)
{
    if (l->unasked == 0) return;
    log_warn(
        "flight: %llu answers are refused: to frames of which nothing was asked; does the recogniser answer another "
        "run's?",
        (unsigned long long)l->unasked);
}

/* ---- what was seen in each frame -------------------------------------------------------------------- */

static void note(FlightLoop *l, int frame, LoopVerdict verdict, const double px[2])
{
    if (l->row_count == l->row_room) {
        const int room = l->row_room ? 2 * l->row_room : 256;
        LoopRow  *more = realloc(l->row, (size_t)room * sizeof *more);
        l->out_of_memory |= !more;
        if (!more) return;
        l->row = more, l->row_room = room;
    }
    const bool seen = verdict == LOOP_SEEN;
    l->row[l->row_count++] = (LoopRow){frame, verdict, {seen ? px[0] : NAN, seen ? px[1] : NAN}};
}

static void settle(FlightLoop *l, const LoopFrame *f, LoopVerdict verdict, const double px[2])
{
    l->verdicts[verdict]++;
    if (verdict == LOOP_SEEN) guide(l, &f->camera, px);
    pthread_mutex_lock(&l->lock);
    l->settled = f->number; /* what comes later is refused, as is what came just now */
    l->late += verdict == LOOP_NONE && l->inbox[l->first].there;
    l->first = (l->first + 1) % loop_waiting_most;
    l->count--;
    pthread_mutex_unlock(&l->lock);
}

/* As the recording has it. */
static void settle_recorded(FlightLoop *l, const LoopFrame *f)
{
    for (int i = 0; i < l->row_count; i++)
        if (l->row[i].frame == f->number) {
            settle(l, f, l->row[i].sight, l->row[i].px);
            return;
        }
    if (!l->strange) log_error("fly: the sights have no frame %d: they are of another flight", f->number);
    l->strange = true;
    settle(l, f, LOOP_NONE, NULL);
}

/* Whether nothing more is to be expected of this frame's answer. */
static bool too_late(FlightLoop *l, const LoopFrame *f)
{
    static const double on_the_way_s = 0.2; /* what a recogniser sent before it ended */
    const double        now_s = wall_clock_s();
    if (l->gone && l->gone_s == 0 && l->gone(l->user)) l->gone_s = now_s;
    if (l->gone_s > 0 && now_s - l->gone_s > on_the_way_s) return true;
    return now_s - f->asked_s > (l->settled < 0 ? fmax(l->start_s, l->limit_s) : l->limit_s);
}

/* Waits for a hundredth of a second at most. The lock must be held. */
static void await(FlightLoop *l)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += 10000000;
    if (until.tv_nsec >= 1000000000) until.tv_nsec -= 1000000000, until.tv_sec++;
    pthread_cond_timedwait(&l->arrived, &l->lock, &until);
}

static bool settle_answered(FlightLoop *l, const LoopFrame *f)
{
    double      px[2] = {NAN, NAN};
    LoopVerdict verdict = LOOP_NONE;
    const bool  over = too_late(l, f);
    pthread_mutex_lock(&l->lock);
    if (!answer_at(l, l->first) && !over) await(l);
    const LoopAnswer *a = answer_at(l, l->first);
    if (a) verdict = choose(px, l, &f->camera, a);
    pthread_mutex_unlock(&l->lock);
    if (!a && !over) return false;
    note(l, f->number, verdict, px);
    settle(l, f, verdict, px);
    return true;
}

bool loop_sights_settle(FlightLoop *l, double t_s)
{
    while (l->count > 0) {
        const LoopFrame f = l->waiting[l->first];
        if (!(f.camera.t_s + l->late_s < t_s - 1e-9)) return true;
        if (l->source == LOOP_RECORDED) settle_recorded(l, &f);
        else if (!settle_answered(l, &f)) return false;
    }
    return true;
}

/* Where of the waiting frames the newest is that is answered; -1: none is. */
static int newest_answered(FlightLoop *l)
{
    int newest = -1;
    pthread_mutex_lock(&l->lock);
    for (int i = 0; i < l->count; i++)
        if (answer_at(l, (l->first + i) % loop_waiting_most)) newest = i;
    pthread_mutex_unlock(&l->lock);
    return newest;
}

void loop_sights_arrived(FlightLoop *l, double t_s)
{
    static const double longest_s = 1;
    int                 answered = newest_answered(l);
    l->least_from_s = t_s;
    for (; l->count > 0; answered--) {
        const LoopFrame f = l->waiting[l->first];
        double          px[2] = {NAN, NAN};
        LoopVerdict     verdict = LOOP_NONE;
        if (answered < 0 && t_s - f.camera.t_s <= longest_s && l->count < loop_waiting_most - 1) break;
        pthread_mutex_lock(&l->lock);
        const LoopAnswer *a = answer_at(l, l->first);
        if (a) verdict = choose(px, l, &f.camera, a);
        pthread_mutex_unlock(&l->lock);
        settle(l, &f, verdict, px);
    }
    l->least_from_s = -INFINITY;
}

/* The strongest within a sixth of the image's width about where the target is expected. */
void loop_sights_echoes(FlightLoop *l, const LoopEcho *echo, int count)
{
    const LoopCamera *c = &l->eye;
    const double      gate = cos(atan(gate_widths * c->view.width / c->view.focal_px));
    double            d[3], los[3];
    int               best = -1;
    expected(d, l, c);
    for (int i = 0; i < count; i++) {
        m3_mul_v3(los, c->r_ecef_from_cam, echo[i].d_cam);
        if (v3_dot(los, d) >= gate && (best < 0 || echo[i].snr > echo[best].snr)) best = i;
    }
    const LoopVerdict verdict = count == 0 ? LOOP_EMPTY : best < 0 ? LOOP_OUTSIDE : LOOP_SEEN;
    l->verdicts[verdict]++;
    if (best < 0) return;
    m3_mul_v3(los, c->r_ecef_from_cam, echo[best].d_cam);
    if (v3_normalize(los, los)) loop_sights_direct(l, los, echo[best].range_m, echo[best].closing_mps);
}

void loop_sights_frame(FlightLoop *l, int number)
{
    l->frames++;
    if (l->source == LOOP_TRUE) guide_truly(l, &l->eye);
    if (l->source != LOOP_ANSWERS && l->source != LOOP_RECORDED) return;
    if (l->count == loop_waiting_most) { /* cannot be: flight_clock_begin has asked for fewer */
        const LoopFrame oldest = l->waiting[l->first];
        settle(l, &oldest, LOOP_NONE, NULL);
    }
    pthread_mutex_lock(&l->lock);
    const int at = (l->first + l->count++) % loop_waiting_most;
    l->waiting[at] = (LoopFrame){number, wall_clock_s(), l->eye};
    l->inbox[at].there = false;
    pthread_mutex_unlock(&l->lock);
}

/* ---- the recording --------------------------------------------------------------------------------- */

Status loop_sights_write(const FlightLoop *l, const char *path)
{
    FILE *file = output_begin(path, 0);
    if (!file) {
        log_error("fly: cannot write %s: %s", path, output_reason(errno));
        return STATUS_IO;
    }
    fputs("frame,sight,column_px,row_px\n", file);
    for (int i = 0; i < l->row_count; i++) {
        const LoopRow *r = &l->row[i];
        fprintf(file, "%d,%s,", r->frame, loop_verdict_name[r->sight]);
        if (r->sight == LOOP_SEEN) fprintf(file, "%.17g,%.17g\n", r->px[0], r->px[1]);
        else fputs(",\n", file);
    }
    if (output_end(file, path)) return STATUS_OK;
    log_error("fly: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}

static Status take_row(void *user, const void *row, const TableRows *rows, int number)
{
    FlightLoop    *l = user;
    const LoopRow *r = row;
    if (r->sight == LOOP_SEEN && !(isfinite(r->px[0]) && isfinite(r->px[1])))
        return table_rows_refuse(rows, number, "column_px", "a place in the image, with row_px, where sight is seen");
    note(l, r->frame, r->sight, r->px);
    return l->out_of_memory ? STATUS_NO_MEMORY : STATUS_OK;
}

Status loop_sights_read(FlightLoop *l, const char *path)
{
    static const TableColumn columns[] = {
        {"frame", TABLE_INT, TABLE_AT(LoopRow, frame), .low = 0, .high = 999999},
        {"sight", TABLE_CHOICE, TABLE_AT(LoopRow, sight), .choices = "seen, empty, outside, none"},
        {"column_px", TABLE_DOUBLE, TABLE_AT(LoopRow, px[0]), .low = -1e6, .high = 1e6, .absent = TABLE_EMPTY,
         .otherwise = NAN},
        {"row_px", TABLE_DOUBLE, TABLE_AT(LoopRow, px[1]), .low = -1e6, .high = 1e6, .absent = TABLE_EMPTY,
         .otherwise = NAN}};
    static const TableFormat format = {"fly", columns, 4, "`pitviper fly --frames DIR` writes one, DIR/sights.csv",
                                       .most_rows = 1000000};
    LoopRow                  row;
    return table_each(&format, path, &row, sizeof row, take_row, l);
}
