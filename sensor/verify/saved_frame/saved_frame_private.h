/* sensor/verify/saved_frame/saved_frame_private.h: the chunks of a frame file, field by field; each function writes
 * or reads one. */
#ifndef SENSOR_VERIFY_SAVED_FRAME_SAVED_FRAME_PRIVATE_H
#define SENSOR_VERIFY_SAVED_FRAME_SAVED_FRAME_PRIVATE_H

#include "sensor/verify/saved_frame/chunks_private.h"
#include "sensor/verify/saved_frame/saved_frame.h"
#include "sensor/verify/saved_frame/ground_cutout_private.h"

/* Bounds of positions, far beyond any in an image: in ECEF, and in a local frame. */
static const double earth_m = 1e8, local_m = 2e7;

void saved_fields_about(Fields *f, SavedFrame *file);
void saved_fields_settings(Fields *f, SavedFrame *file);
void saved_fields_tables(Fields *f, SavedFrame *file);
void saved_fields_models(Fields *f, SavedFrame *file);
void saved_fields_snapshot(Fields *f, SavedFrame *file);
void saved_fields_request(Fields *f, SavedFrame *file);
void saved_fields_ground(Fields *f, SavedFrame *file, const GroundCutout *kept);
void saved_fields_marks(Fields *f, SavedFrame *file);
void saved_fields_woods(Fields *f, SavedFrame *file);
void saved_fields_scenery(Fields *f, SavedFrame *file);
void saved_fields_shows(Fields *f, SavedFrame *file);
void saved_fields_radar(Fields *f, SavedFrame *file);
void saved_fields_coarse(Fields *f, SavedFrame *file);
void saved_fields_planes(Fields *f, SavedFrame *file);

/* Logs what is not as it was where the frame was made: forced as a warning, else as an error that names --force. */
void saved_say(bool forced, const char *name, const char *what);

#endif
