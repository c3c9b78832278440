/* sensor/frame/frame_display.h: a frame's bands behind their detectors, with gain and level: what files, videos and
 * recognisers show. Made once a frame, in the order of frames, for all consumers. */
#ifndef SENSOR_FRAME_FRAME_DISPLAY_H
#define SENSOR_FRAME_FRAME_DISPLAY_H

#include "render/frame/render.h"
#include "sensor/detector/chain.h"
#include "sensor/detector/level.h"
#include "sensor/settings/sensors.h"
#include "sensor/truth/truth.h"

/* A band's image after its detector, before quantisation. Without a sensor it is radiance, with noise as configured. */
typedef struct FrameDisplay {
    int             planes;   /* 0: none; 1: grey; 3: R, G, B */
    const float    *plane[3]; /* [height][width] */
    bool            decibels; /* radar: power, displayed in dB below the brightest */
    DetectorConfig  detector;
    DetectorLevel   level;     /* displayed as black and white; R G B: balanced */
    DetectorCurve   curve;     /* between the two, where detector.plateau is not 0 */
    const uint16_t *counts[3]; /* raw, [height][width]; NULL: not requested, or no sensor */
    int             count_bits;
} FrameDisplay;

/* An automatic level with a time constant. It starts with the first frame. */
typedef struct FrameLevel {
    bool          known, quick; /* quick: detector_level_follow */
    double        time_s;
    DetectorLevel level;
    DetectorCurve curve; /* instead, of plateau equalisation */
} FrameLevel;

/* The detectors of a picture's bands, with what they carry from frame to frame. */
typedef struct Camera {
    Chain       *chain[BAND_COUNT]; /* NULL: no sensor; white noise as configured */
    FrameLevel   level[BAND_COUNT];
    Acquisition *observed[BAND_COUNT]; /* what an observer of a sensor resolves; NULL: not requested */
} Camera;

/* The detectors of the bands that have a sensor; noise false: without theirs. On failure it is closed. */
Status camera_open(Camera *out, const Sensors *sensors, const Config *config, bool noise);
/* Lets camera_expose say what an observer resolves, too. Some 10 ms a sensor. STATUS_NO_MEMORY. */
Status camera_observe(Camera *camera, const Sensors *sensors, const Config *config);
void   camera_close(Camera *camera);
/* Exposes the sensors for this image, and gives their noise at its mean radiance. */
void camera_expose(TruthNoise *noise, Camera *camera, const Picture *picture, const Config *config);

typedef struct DisplaysOf {
    const Config  *config;
    const Picture *picture;
    const Picture *noise_of; /* the image whose mean white noise is a share of; NULL: picture */
    Camera        *camera;
    int            frame;
    double         time_s;
    double         rate_px_s[2]; /* image motion of the scene: column, row */
    bool           counts;       /* raw counts too */
} DisplaysOf;

/* Exposes and runs the detectors of these bands (1 << Band), one task per band. STATUS_NO_MEMORY. */
Status frame_displays_make(FrameDisplay display[BAND_COUNT], const DisplaysOf *of, unsigned bands, Pool *pool,
                           Arena *arena);
/* Quantises to 8 .. 16 bits: uint8_t (8) or uint16_t values of a grey image, or of R G B interleaved. */
void frame_display_quantise(void *out, const FrameDisplay *display, size_t count, int bits);

#endif
