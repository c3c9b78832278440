/* sensor/publish/emissivity.h: emissivity of each pixel, a truth plane that follows from the plane of materials: it is made
 * when it is written to a file, and is in no hash of a frame. */
#ifndef SENSOR_PUBLISH_EMISSIVITY_H
#define SENSOR_PUBLISH_EMISSIVITY_H

#include "render/frame/picture.h"
#include "render/materials/materials.h"

/* Of the surface at the pixel's centre in a thermal band, 0 .. 1: 1 - reflectance - transmittance of its row of
 * etc/materials.csv or etc/plant_optics.csv, hemispherical; NaN: sky. out: [height][width]. */
void emissivity_plane(float *out, Band band, const Picture *picture, const Materials *materials);

#endif
