/* sensor/score/rates.c: rates of detection and of false alarms, with intervals over sequences. */
#include "sensor/score/rates.h"
#include "sensor/score/interval.h"

void rates_end_sequence(RateSums *s)
{
    const RateCounts *n = &s->now;
    const double      chances = (double)n->chances, frames = (double)n->frames, wrong = (double)n->false_alarms;
    s->chances2 += chances * chances;
    s->frames2 += frames * frames;
    if (n->frames > 0) s->false2_per_frame += wrong * wrong / frames;
    s->sequences += n->chances > 0;
    s->all.chances += n->chances, s->all.found += n->found, s->all.recognised += n->recognised;
    s->all.frames += n->frames, s->all.answered += n->answered, s->all.false_alarms += n->false_alarms;
    s->all.frames_km2 += n->frames_km2, s->all.false_km2 += n->false_km2;
    s->all.deg2 += n->deg2, s->all.km2 += n->km2;
    s->now = (RateCounts){0};
}

static ScoreShare share_of(long long count, long long of, double samples)
{
    if (of == 0) return (ScoreShare){NAN, NAN, NAN};
    const double   share = (double)count / (double)of;
    const Interval i = interval_of_share(share, samples);
    return (ScoreShare){share, i.low, i.high};
}

/* The same false alarms over another measure of the frames. */
static ScoreShare scaled(const ScoreShare *per_frame, long long count, long long frames, double measure)
{
    if (!(measure > 0)) return (ScoreShare){NAN, NAN, NAN};
    const double per = (double)frames / measure;
    return (ScoreShare){(double)count / measure, per_frame->low * per, per_frame->high * per};
}

ScoreRates rates_of(const RateSums *s, double from, double to)
{
    const RateCounts *n = &s->all;
    const double      frames = (double)n->frames, wrong = (double)n->false_alarms;
    ScoreRates        r = {.from = from,
                           .to = to,
                           .chances = n->chances,
                           .found = n->found,
                           .recognised = n->recognised,
                           .frames = n->frames,
                           .frames_answered = n->answered,
                           .false_alarms = n->false_alarms,
                           .deg2 = n->deg2,
                           .km2 = n->km2,
                           .sequences = s->sequences,
                           .samples = interval_samples((double)n->chances, s->chances2)};
    r.detection = share_of(n->found, n->chances, r.samples);
    r.recognition = share_of(n->recognised, n->chances, r.samples);
    r.per_frame = (ScoreShare){NAN, NAN, NAN};
    if (n->frames > 0) {
        const double   mean = wrong / frames;
        const Interval i = interval_of_count(mean, interval_samples(frames, s->frames2),
                                             interval_dispersion(wrong, s->false2_per_frame, frames, s->frames2));
        r.per_frame = (ScoreShare){mean, i.low, i.high};
    }
    r.per_deg2 = scaled(&r.per_frame, n->false_alarms, n->frames, n->deg2);
    r.per_km2 = scaled(&r.per_frame, n->false_km2, n->frames_km2, n->km2);
    return r;
}
