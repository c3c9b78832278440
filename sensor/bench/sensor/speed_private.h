/* sensor/bench/sensor/speed_private.h: shared by the files of `bench speed`. */
#ifndef SENSOR_BENCH_SENSOR_SPEED_PRIVATE_H
#define SENSOR_BENCH_SENSOR_SPEED_PRIVATE_H

#include "sensor/bench/sensor/speed.h"

#include "sensor/quality/trial.h"

enum { what_size = 160 };

static const unsigned    three_bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR;
static const char *const all_threads = "all threads"; /* their number is printed above the table */

typedef struct Speed {
    Bench     *bench;
    int        width, height;
    double     east_m, north_m;
    LocalFrame frame;
    Landscape  landscape;
    TrialScene scene, close;   /* twenty vehicles; one */
    Pool      *one, *many;
    Arena     *arena[3];       /* of frames on many threads, on one, and others */
    char       target[96];     /* what fills the image, and the sensor position */
} Speed;

/* Whether the rows of `optical` (pictures of all bands) or `radar` are asked for: --bands names one of them. */
bool          speed_wants(const Bench *bench, const char *rows);
RenderRequest speed_request(const View *view, unsigned bands, bool truth);
TrialFrame    speed_frame(const Speed *s, const TrialScene *scene, const RenderRequest *request, bool many);
/* The rows of a frame's files; of memory. */
Status        speed_files(Speed *s);
void          speed_memory(Speed *s);
/* The rows of a world's set-up by parts, and of a sweep's variant. */
Status        speed_start(Speed *s);
/* The rows of the ground's heat; warms the scene's world. */
Status        speed_heat(Speed *s);

#endif
