/* entities/probe.c: the probes of entities: dead reckoning, articulation and models, one row at a time. */
#include "entities/probe_private.h"

#include "entities/motion/dead_reckoning.h"

static void three(double out[3], const ProbeValue *in)
{
    /* optional ones that are absent count as 0 */
    for (int k = 0; k < 3; k++) out[k] = isnan(in[k].number) ? 0 : in[k].number;
}

static const char *dead_reckon_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    const double algorithm = in[0].number;
    if (!(algorithm >= 1 && algorithm <= 9 && algorithm == floor(algorithm)))
        return "algorithm must be 1 .. 9 (IEEE 1278.1: static, FPW, RPW, RVW, FVW, FPB, RPB, RVB, FVB)";

    Kinematics k = {.algorithm = (int)algorithm};
    Motion     moved;
    double     euler_rad[3];
    three(k.p_ecef, in + 1);
    three(euler_rad, in + 4);
    three(k.v_mps, in + 7);
    three(k.a_mps2, in + 10);
    three(k.w_body_rps, in + 13);
    r_ecef_from_body_euler(k.r_ecef_from_body, euler_rad[0], euler_rad[1], euler_rad[2]);
    dead_reckon(&moved, &k, in[16].number);
    for (int i = 0; i < 9; i++)
        if (!isfinite(moved.p_ecef[i % 3]) || !isfinite(moved.r_ecef_from_body[i]))
            return "distance, rotation or its square exceeds 1e308";
    for (int i = 0; i < 3; i++) out[i].number = moved.p_ecef[i];
    euler_from_r_ecef_from_body(&out[3].number, &out[4].number, &out[5].number, moved.r_ecef_from_body);
    return NULL;
}

const Probe entities_probes[] = {
    {.name = "deadreckon",
     .help = "position and attitude of an Entity State extrapolated by dt_s (IEEE 1278.1 Annex E): ECEF metres, Euler "
             "angles in "
             "radians, velocity and acceleration in world axes for algorithms 1-5, body axes for 6-9",
     .in =
         "algorithm,x_m,y_m,z_m,psi_rad,theta_rad,phi_rad,vx_mps,vy_mps,vz_mps,ax_mps2?,ay_mps2?,az_mps2?,wx_rps?,wy_rps?,"
         "wz_rps?,dt_s",
     .out = "dr_x_m,dr_y_m,dr_z_m,dr_psi_rad,dr_theta_rad,dr_phi_rad",
     .row = dead_reckon_row},
    {.name = "flight",
     .help =
         "flight of a missile of etc/missiles.csv (TABLE: of another) from a place, with true sight of a target that "
         "keeps its acceleration, east, north, up at the launch: state at its end, ECEF, and closest approach "
         "(etc/reference/flight.md). Ends at until_s, life, fuze, ground_u_m, or past the target. sight_every_s: time "
         "between measurements, each sight_late_s old; ranged: 0: without range; earth: 1, 0: neither gravity nor "
         "turning, 2: without turning; air: factor of density",
     .arguments = "[TABLE]",
     .in =
         "missile$,lat_deg,lon_deg,height_m,azimuth_deg,elevation_deg,speed_mps?,target_e_m?,target_n_m?,target_u_m?,"
         "target_ve_mps?,target_vn_mps?,target_vu_mps?,target_ae_mps2?,target_an_mps2?,target_au_mps2?,until_s?,step_s?,"
         "sight_every_s?,sight_late_s?,ranged?,ground_u_m?,earth?,air?",
     .out = "end_s,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,mass_kg,mach,lateral_mps2,attack_deg,most_lateral_mps2,"
            "most_attack_deg,most_gimbal_deg,miss_m,miss_s,miss_e_m,miss_n_m,miss_u_m,fuze_s,end$,sight$,guided_steps",
     .open = flight_probe_open,
     .row = flight_probe_row,
     .close = flight_probe_close},
};
const int entities_probe_count = sizeof entities_probes / sizeof *entities_probes;
