"""The themes of the gallery, and for each example its function, caption, formulas and references.

A caption can be read without the text and ends with the number to remember; {0} is the first number
of the example.
"""

THEMES = {
    "Work and energy": ["two_frames", "time_reversal"],
    "Stick and slip": [
        "stick_slip",
        "friction_loop",
        "depinning",
        "thermal_friction",
        "friction_against_speed",
    ],
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
    "Rough surfaces": ["rough_grid", "rough_surface", "load_and_energy", "measured_block"],
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
    "friction_loop": (
        "loop",
        "Force of a stage that pulls a tip over a corrugation forth and back, in units of the "
        "static friction $F_c$. Lines show $\\pm F_c$; at a slip the force is up to "
        "{0:.3f} $F_c$.",
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
    "measured_block": (
        "scene",
        "A block with the heights of a scan (above left) on an elastic body, pulled forth and back "
        "over a table of spheres. Above right: mean normal force on each asperite at a load of "
        "40. Below: friction against load with 95 % intervals, loop, drops of the force in slips "
        "with intervals, and energy budget. The contact carries the load: {0:.3f} of it.",
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

# Name -> the formulas of its docstring, as written there and as LaTeX.
FORMULAS = {
    "stick_slip": {
        "-A cos(2 pi x / a)": r"$-A \cos(2\pi x/a)$",
        "1/K = 1/k + length^2/kappa": r"$1/K = 1/k + \ell^2/\kappa$",
        "eta = 4 pi^2 A / (K a^2) > 1": r"$\eta = 4\pi^2 A/(K a^2) > 1$",
        "eta < 1": r"$\eta < 1$",
        "eta > 1": r"$\eta > 1$",
    },
    "depinning": {
        "-A cos(2 pi x / a)": r"$-A \cos(2\pi x/a)$",
        "F_c = 2 pi A / a": r"$F_c = 2\pi A/a$",
        "    v = sqrt(F^2 - F_c^2) / gamma .": r"$$ v = \sqrt{F^2 - F_c^2} / \gamma . $$",
    },
    "structural_lubricity": {
        "    F_N = F_1 |sin(pi N s / a) / sin(pi s / a)| .": (
            r"$$ F_N = F_1 \left| \frac{\sin(\pi N s/a)}{\sin(\pi s/a)} \right| . $$"
        ),
        "F_N is N F_1": "$F_N$ is $N F_1$",
        "s/a - 1 of 1/N": "$s/a - 1$ of $1/N$",
    },
    "commensurate_rows": {
        "F_1 |sin(pi N g) / (N sin(pi g))|": r"$F_1\, |\sin(\pi N g) / (N \sin(\pi g))|$",
        "friction F_1 of": "friction $F_1$ of",
    },
    "aubry_transition": {
        "-A cos(2 pi x / a)": r"$-A \cos(2\pi x/a)$",
        "    K = 4 pi^2 A / (k a^2) = 0.971635": r"$$ K = 4\pi^2 A / (k a^2) = 0.971635 $$",
        "g = (sqrt(5) - 1) / 2": r"$g = (\sqrt 5 - 1)/2$",
        "-det(H)/4": r"$-\det(H)/4$",
    },
    "friction_against_load": {
        "sin(alpha) = a / (2 d)": r"$\sin\alpha = a/(2d)$",
        "slope alpha with": r"slope $\alpha$ with",
        "    F = N tan(alpha) ,": r"$$ F = N \tan\alpha , $$",
    },
    "friction_against_speed": {"(2 pi A / a)": r"($2\pi A/a$)"},
    "friction_loop": {
        "-A cos(q x)": r"$-A \cos(q x)$",
        "F_c = A q": "$F_c = A q$",
        "force is F_c": "force is $F_c$",
    },
    "washboard_resonance": {
        "-A cos(q x)": r"$-A \cos(q x)$",
        "w = q v": r"$\omega = q v$",
        "    F = (A q)^2 / (2 v) Re Y ,   Y = 1 / (g - i (w I - kappa / w)) ,": (
            r"$$ F = \frac{(A q)^2}{2 v} \operatorname{Re} Y , \qquad "
            r"Y = \frac{1}{g - i(\omega I - \kappa/\omega)} , $$"
        ),
        "w^2 = kappa / I": r"$\omega^2 = \kappa/I$",
        "stiffness kappa": r"stiffness $\kappa$",
    },
    "free_block": {
        "-A cos(q x)": r"$-A \cos(q x)$",
        "    F = (A q)^2 / (2 V) Re Y(q V) ,   Y(w) = 1 / (-i w M + sum_n K_n(w)) ,": (
            r"$$ F = \frac{(A q)^2}{2 V} \operatorname{Re} Y(q V) , \qquad "
            r"Y(\omega) = \frac{1}{-i \omega M + \sum_n K_n(\omega)} , $$"
        ),
        "K_n is": "$K_n$ is",
    },
    "heat_into_baths": {
        "gamma w_c exp(-w_c t)": r"$\gamma \omega_c\, e^{-\omega_c t}$",
        "p' = -w_c p - gamma w_c v_bar": (r"$p' = -\omega_c p - \gamma \omega_c v_{\mathrm{bar}}$"),
    },
    "diffusion": {
        "-A cos(2 pi x / a)": r"$-A \cos(2\pi x/a)$",
        "    D = T / (gamma I_0(A / T)^2) ,": r"$$ D = \frac{T}{\gamma\, I_0(A/T)^2} , $$",
        "I_0 is": "$I_0$ is",
    },
    "rough_grid": {
        "    share in contact = integral over z > d of phi(z) ,\n"
        "    load per asperite = (5 A / 2 D) integral over z > d of ((z - d) / D)^(3/2) phi(z) .": (
            r"$$ \text{share in contact} = \int_d^\infty \phi(z)\, dz , \qquad "
            r"\text{load per asperite} = \frac{5 A}{2 D} \int_d^\infty "
            r"\Bigl( \frac{z - d}{D} \Bigr)^{3/2} \phi(z)\, dz . $$"
        ),
        "density phi": r"density $\phi$",
    },
    "squeezed_layers": {
        "    U = A cos(2 pi r / s) exp(-r / l) ,": r"$$ U = A \cos(2\pi r/s)\, e^{-r/l} , $$",
        "2 pi r_k / s = 2 atan(2 pi l / s) - pi / 2 + 2 pi k": (
            r"$2\pi r_k/s = 2 \arctan(2\pi l/s) - \pi/2 + 2\pi k$"
        ),
        "    F_k = (2 pi A / s) exp(-r_k / l) ,": r"$$ F_k = (2\pi A/s)\, e^{-r_k/l} , $$",
        "exp(s / l) times": r"$e^{s/l}$ times",
    },
}

# Name -> for each number of the example, the number to compare with and the unit.
REFERENCES = {
    "two_frames": (("0.520 (paper)", "energy"), ("0", "energy"), ("", "energy")),
    "time_reversal": (("0.520 (paper)", "energy"), ("0", "energy"), ("0", "rad")),
    "stick_slip": (("0 (slow pull)", "energy"), ("1", "ratio")),
    "friction_loop": (("1", "ratio"), ("-1", "ratio"), ("0", "energy")),
    "depinning": (("0", "F_c / gamma"), ("0.75", "F_c / gamma")),
    "thermal_friction": (("", "A / a"),) * 6,
    "friction_against_speed": (("1", "ratio"),) * 4,
    "structural_lubricity": (("1", "F of a row that fits"), ("0.6368", "F of a row that fits")),
    "commensurate_rows": (("1", "ratio"), ("0.6753", "ratio")),
    "aubry_transition": (("0.971635 (Greene)", "ratio"),),
    "friction_against_load": (("0.2582", "ratio"), ("0.2582", "ratio")),
    "washboard_resonance": (("1", "ratio"),),
    "free_block": (("0.1353 (next row)", "velocity"), ("", "velocity")),
    "heat_into_baths": (("", "time"), ("0", "first energy"), ("", "time"), ("0", "first energy")),
    "diffusion": (("0.9694", "ratio"), ("0.6239", "ratio"), ("0.1924", "ratio"), ("", "ratio")),
    "rough_grid": (("1", "ratio"), ("", "ratio")),
    "measured_block": (("1", "ratio"), ("1", "ratio"), ("1", "ratio"), ("0", "ratio")),
    "rough_surface": (("", "ratio"), ("0", "ratio")),
    "load_and_energy": (("1 (Amontons)", "ratio"), ("0", "ratio")),
    "squeezed_layers": (("1", "ratio"),) * 3,
    "postcard": (("", "energy"), ("0", "energy"), ("", "energy"), ("", ""), ("9", "")),
}
