/* render/scattering/signatures/given_signature.h: what a target scatters as the user gives it, measured or from
 * another program, in place of its model: a CSV file, either of cross sections over the look, or of scatterers.
 *
 *     az_deg,el_deg,f_ghz,hh_dbsm,vv_dbsm                  az_deg,el_deg,f_ghz,hh_re_m,hh_im_m,vv_re_m,vv_im_m
 *     0,10,35,12.5,13.1                                    0,10,35,1.1,-0.4,1.0,-0.5
 *     1,10,35,11.9,12.7                                    ...
 *
 * Cross sections: a row for each azimuth, elevation and frequency of a complete grid, in any order; the rcs.csv of
 * `pitviper rcs` is one. hv, vh: 0 where neither is given, each other where one is. With complex fields (scatter.h:
 * m, phase centre the body's origin) values between rows are linear in the field, which is right where the grid
 * follows its phase, less than a radian or so from row to row; without, they are linear in decibels and of no
 * phase. All of it comes from the body's origin, as from one point.
 *
 *     x_m,y_m,z_m,hh_dbsm,vv_dbsm,hh_deg,vv_deg,az_deg,az_width_deg,el_deg,el_width_deg
 *     3.2,0,-1.1,8,8,0,180,0,60,,
 *
 * Scatterers: a row each, body axes, m; phases in deg (0), seen within az_width (360) about az (0) and el_width (180)
 * about el (0), at every frequency. hv_dbsm, hv_deg: of both cross-polarised fields (none).
 *
 * A grid is known half a step beyond its ends, a single elevation 2.5 degrees and a single azimuth 0.5 degrees to
 * either side, all round where its azimuths go round; frequencies 5 % beyond the ends. Azimuth is clockwise from the
 * nose as seen from above, elevation upwards. */
#ifndef RENDER_SCATTERING_SIGNATURES_GIVEN_SIGNATURE_H
#define RENDER_SCATTERING_SIGNATURES_GIVEN_SIGNATURE_H

#include "dis/pdu/pdu.h"
#include "render/scattering/signatures/centres.h"

typedef struct GivenSignature GivenSignature;

/* Of a target's name given:FILE, the file; NULL: it is another name. */
const char *given_signature_path(const char *name);

/* STATUS_BAD_VALUE, STATUS_IO, STATUS_NO_MEMORY: logged with file and line. */
Status given_signature_open(GivenSignature **out, const char *path);
void   given_signature_close(GivenSignature *given); /* accepts NULL */
/* Whether it is known at a look and frequency; scatterers are everywhere. */
bool given_signature_knows(const GivenSignature *given, const ScatterAntenna *antenna, double frequency_hz);
/* What it scatters back, where it is known; else 0. */
void given_signature_field(ScatterMatrix *s, const GivenSignature *given, const ScatterAntenna *antenna,
                           double frequency_hz);
/* Gives scattering centres whose sum this signature is; their part is -1. A centre of no amplitude is left out. */
Status given_signature_centres(Centres *out, const GivenSignature *given, const ScatterAntenna *antenna,
                               double frequency_hz);

/* ---- the list: which entities scatter by a signature that is given ---------------------------------------- */

/* A CSV file with a row for each.
 *
 *     entity,signature
 *     tank,measured/tank_ka.csv
 *     1:1:7,decoy.csv
 *
 * entity: a DIS entity id, the name of a model, or * for all; what names an entity wins over a model, that over *.
 * signature: a file as above, relative to the folder of the list. */
typedef struct GivenList GivenList;

/* Reads every signature. STATUS_BAD_VALUE, STATUS_IO, STATUS_NO_MEMORY: logged with file and line. */
Status given_list_open(GivenList **out, const char *path);
void   given_list_close(GivenList *list); /* accepts NULL */
/* NULL: none is given. list may be NULL. model: its name. */
const GivenSignature *given_list_find(const GivenList *list, DisEntityId id, const char *model);

#endif
