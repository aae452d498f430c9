"""The themes of the gallery, and for each example the function to show and its caption.

A caption can be read without the text and ends with the number to remember; {0} is the first number
of the example.
"""

THEMES = {
    "Work and energy": ["two_frames", "time_reversal"],
    "Stick and slip": ["stick_slip", "depinning", "thermal_friction", "friction_against_speed"],
    "Rows that fit and rows that do not": [
        "structural_lubricity",
        "commensurate_rows",
        "aubry_transition",
        "friction_against_load",
    ],
    "Vibrations and diffusion": [
        "washboard_resonance",
        "free_block",
        "heat_into_baths",
        "diffusion",
    ],
    "Rough surfaces": ["rough_grid", "rough_surface", "load_and_energy"],
    "Potentials that are not built in": ["squeezed_layers", "postcard"],
}

# Name -> the function to show, and the caption.
CAPTIONS = {
    "two_frames": (
        "works",
        "Work and pseudowork of the contact in case A of the paper, and the internal "
        "energy, against the velocity that an observer adds to all surfaces. Work and pseudowork "
        "change by the same amount; for all observers the internal energy is {0:.3f}.",
    ),
    "time_reversal": (
        "reversed_scene",
        "Angle of the upper pendulum of case A. The bobs pass each other, and at t = 40 "
        "all velocities are reversed. The pendulum returns its internal energy of {0:.3f}.",
    ),
    "stick_slip": (
        "pull",
        "Left: force of a slow pull over a corrugation. For $\\eta = 0.7$ the bob "
        "follows smoothly; for $\\eta = 4$ it sticks, and slips once per period. Right: "
        "the work per period is zero below $\\eta = 1$. At $\\eta = 4$, work / energy of "
        "a jump = {1:.3f}.",
    ),
    "depinning": (
        "velocities",
        "Mean velocity of an overdamped particle under a constant force. The particle "
        "stands still up to the static friction $F_c$; at $1.25\\,F_c$ its velocity is "
        "{1:.3f} $F_c/\\gamma$ (closed form: 0.750).",
    ),
    "thermal_friction": (
        "runs",
        "Work of a pull over three periods at three temperatures. Lines show means of 48 "
        "runs, and bands show their 95 % intervals. The slope of a line is the friction: "
        "in the last period its mean is {0:.2f} ± {1:.2f} $A/a$ at $T = 0.01\\,A$; at "
        "$0.3\\,A$ it is {4:.2f} ± {5:.2f}.",
    ),
    "friction_against_speed": (
        "friction",
        "Friction of a warm tip against its speed. Points are means of 40 tips with "
        "95 % intervals; the line follows from Kramers' rate of escape. At the lowest "
        "speed, simulation / theory = {0:.2f}.",
    ),
    "structural_lubricity": (
        "static_friction",
        "Static friction of a rigid row of 40 atoms against its misfit with the "
        "substrate. It vanishes where the misfit adds up to whole periods over the row. "
        "At half a period, friction / friction of a row that fits = {1:.3f}.",
    ),
    "commensurate_rows": (
        "rows",
        "Static friction per asperite of rows of N asperites. Rows that fit (blue) keep "
        "the friction of one asperite; rows with a golden ratio of spacings (orange) "
        "lose it. Lines are the closed form, and the shaded area contains it for every "
        "N. For 256 that do not fit, friction of the whole row / that of one asperite = "
        "{1:.2f}.",
    ),
    "aubry_transition": (
        "residue",
        "Magnitude of Greene's residue of rings of atoms, against the strength of the "
        "substrate. Below the crossing it falls with the length of the ring, and the "
        "chain slides; above, it grows, and the chain is pinned. The curves of 21 and 55 "
        "atoms cross at $K$ = {0:.4f} (exact: 0.9716, dotted).",
    ),
    "friction_against_load": (
        "static_friction",
        "Static friction of a hard sphere that rests between two spheres of a row, "
        "against the load. The line shows the slope that it must climb, {1:.4f}; the "
        "slope of the points is {0:.4f}.",
    ),
    "washboard_resonance": (
        "friction",
        "Friction of a pendulum whose bar moves over a corrugation, against the "
        "frequency at which the corrugation shakes it. At the resonance, simulation / "
        "closed form = {0:.3f}.",
    ),
    "free_block": (
        "simulated_speed",
        "Speed of a block that slides freely over a corrugation and shakes the "
        "oscillators inside it. Points are means over one period of the corrugation, "
        "the grey line is the speed of block and oscillators together, and the orange "
        "line is the closed form. The speed falls from 0.4 by {0:.3f}; the closed form "
        "gives {1:.3f}.",
    ),
    "heat_into_baths": (
        "swing_energy",
        "Left: energy of a swing that a bath on the bar damps, relative to its first "
        "value; 40 oscillators return most of it from t = 60 on. Right: difference from "
        "a continuum of oscillators. Up to the dotted times, tribo expects a bath to act "
        "as a continuum: {0:.0f} for 40 oscillators and {2:.0f} for 160.",
    ),
    "diffusion": (
        "diffusion",
        "Diffusion of 8000 particles on a corrugation of amplitude A, relative to that "
        "without one, with 95 % intervals. The line is $1/I_0(A/T)^2$. At $A/T = 2$ the "
        "ratio is {2:.2f} ± {3:.2f}.",
    ),
    "rough_grid": (
        "pressed",
        "Left: heights of a rough grid of $64 \\times 64$ asperites; orange squares mark those "
        "that touch a flat grid when a tenth of them are in contact. Right: share in contact "
        "against the load, and the theory of Greenwood and Williamson. Twice the load of "
        "the left map multiplies the share in contact by {1:.2f}.",
    ),
    "rough_surface": (
        "surface",
        "Above: two rough rows slide over each other, at half of the run. Below: the work "
        "since the start, and the energies that it becomes. At the end, heat / work = "
        "{0:.2f}.",
    ),
    "load_and_energy": (
        "pull",
        "Left: friction of a rough grid of $16 \\times 16$ asperites against the load, with 95 "
        "% intervals and a power law. Right: the work of the drive under the largest "
        "load, and the energies that it becomes. The exponent of the power law is "
        "{0:.2f}.",
    ),
    "squeezed_layers": (
        "pressed",
        "Left: energy of a gap that a layered liquid fills. Right: the gap under a load "
        "that grows slowly; orange points show where a layer breaks by the closed form. "
        "For the third break, load in the simulation / closed form = {2:.3f}.",
    ),
    "postcard": (
        "main",
        "Left: energy and force of a user's own potential. Right: work of the drives "
        "while 64 bobs slide over 64 others that repel them by this potential, and the change of "
        "the total energy (dashed). The work at the end is {0:.4f}.",
    ),
}
