/* tests/tools/track_scores.c: random sequences of truths and tracks with their scores, for a judge:
 *
 *     track_scores FIRST COUNT [alone]
 *
 * of the sequences of these numbers, a line of JSON each: its frames - truths with id and hidden, tracks, similarities
 * of all pairs - and the scores. alone: a truth overlaps one answer at most and the other way, and none is hidden. */
#include "sensor/score/tracks.h"

#include <stdlib.h>

enum { frames_most = 60, truths_most = 7, answers_most = 9 };

static uint64_t sequence_number;
static uint64_t drawn;
static double   draw(void) { return random_uniform(20261130, 7, (uint32_t)sequence_number, drawn++); }
static int      draw_below(int n) { return (int)(draw() * n); }

static void put_score(const TracksScore *s)
{
#define EACH(member) printf("\"" #member "\":%llu,", (unsigned long long)s->member)
    EACH(frames), EACH(present), EACH(answers), EACH(idtp), EACH(idfp), EACH(idfn), EACH(idtp_dropped), EACH(matched);
    EACH(switches), EACH(fragmentations), EACH(truths), EACH(mostly_tracked), EACH(mostly_lost), EACH(tracks);
    EACH(beside);
#undef EACH
    printf("\"similarity\":%.17g", s->similarity);
    const double ratios[] = {tracks_idf1(s), tracks_idp(s), tracks_idr(s), tracks_mota(s)};
    for (int k = 0; k < 4; k++)
        if (isfinite(ratios[k])) printf(",\"%s\":%.17g", (const char *[]){"idf1", "idp", "idr", "mota"}[k], ratios[k]);
}

static void put_frame(const TracksFrame *f, double similarity[truths_most][answers_most])
{
    printf("{\"truth\":[");
    for (int i = 0; i < f->truths; i++) printf("%s%d", i ? "," : "", (int)f->truth[i].id);
    printf("],\"hidden\":[");
    for (int i = 0; i < f->truths; i++) printf("%s%d", i ? "," : "", f->truth[i].hidden);
    printf("],\"track\":[");
    for (int j = 0; j < f->answers; j++) printf("%s%u", j ? "," : "", f->answer[j].track);
    printf("],\"similarity\":[");
    for (int i = 0; i < f->truths; i++) {
        printf("%s[", i ? "," : "");
        for (int j = 0; j < f->answers; j++) printf("%s%.17g", j ? "," : "", similarity[i][j]);
        printf("]");
    }
    printf("]}");
}

/* A different number of all from 1 .. most, in the order of drawing. */
static int draw_some(int *out, int most, double share)
{
    int count = 0;
    for (int k = 1; k <= most; k++) {
        if (draw() >= share) continue;
        const int at = draw_below(count + 1);
        out[count++] = out[at];
        out[at] = k;
    }
    return count;
}

static int put_sequence(bool alone)
{
    drawn = 0;
    const int frames = 1 + draw_below(frames_most), truths = 1 + draw_below(truths_most),
              tracks = 1 + draw_below(answers_most), swap = 1 + draw_below(20);
    const double present = draw_below(4) ? 0.3 + 0.7 * draw() : 0.15,
                 answered = draw_below(4) ? 0.3 + 0.7 * draw() : 0.1, loose = draw(),
                 hides = alone ? 0 : 0.3 * draw_below(2);
    Tracks *t;
    if (tracks_create(&t, 0.5) != STATUS_OK) return 1;
    printf("{\"sequence\":%d,\"frames\":[", (int)sequence_number);
    for (int n = 0; n < frames; n++) {
        int          id[truths_most], track[answers_most];
        TracksTruth  truth[truths_most];
        TracksAnswer answer[answers_most];
        TracksPair   pair[truths_most * answers_most];
        double       similarity[truths_most][answers_most] = {{0}};
        TracksFrame  f = {.t_s = n, .truth = truth, .answer = answer, .pair = pair};
        f.truths = draw_some(id, truths, present);
        f.answers = draw_some(track, tracks, answered);
        for (int i = 0; i < f.truths; i++) truth[i] = (TracksTruth){(uint64_t)id[i], draw() < hides};
        for (int j = 0; j < f.answers; j++) answer[j] = (TracksAnswer){.track = (uint32_t)track[j]};
        for (int i = 0; i < f.truths; i++)
            for (int j = 0; j < f.answers; j++) {
                /* a track is on one truth for a while, and near others now and then */
                const bool   on = (track[j] + n / swap) % truths + 1 == id[i];
                const double s = on ? 0.2 + 0.8 * draw() : alone || draw() >= 0.5 * loose ? 0 : draw();
                similarity[i][j] = s;
                bool taken = false;
                for (int k = 0; k < j; k++) taken = taken || similarity[i][k] >= 0.5;
                for (int k = 0; k < i; k++) taken = taken || similarity[k][j] >= 0.5;
                if (alone && taken) similarity[i][j] = 0;
                if (similarity[i][j] > 0) pair[f.pairs++] = (TracksPair){i, j, similarity[i][j]};
            }
        if (n) printf(",");
        put_frame(&f, similarity);
        if (tracks_frame(t, &f) != STATUS_OK) return 1;
    }
    TracksScore score;
    if (tracks_score(&score, t) != STATUS_OK) return 1;
    printf("],\"score\":{");
    put_score(&score);
    printf("}}\n");
    tracks_destroy(t);
    return 0;
}

int main(int argc, char **argv)
{
    if (argc < 3) return 2;
    const uint64_t first = strtoull(argv[1], NULL, 10), count = strtoull(argv[2], NULL, 10);
    for (uint64_t k = first; k < first + count; k++) {
        sequence_number = k;
        if (put_sequence(argc > 3)) return 1;
    }
    return 0;
}
