"""How a run can end: an integer code inside kernels, a `Status` everywhere else; its counts."""

from enum import StrEnum

COMPLETED, PAUSED, BOBS_COINCIDE, STEP_UNDERFLOW = range(4)
NOT_FINITE, ENCOUNTER_JUMPED, NOT_CONVERGED = range(4, 7)

# Columns of the counts of a run: the code of its status, steps, and evaluations of all forces.
CODE, STEPS, EVALUATIONS = range(3)
COUNTS = 3


class Status(StrEnum):
    """How a run ended; each member equals its name as a string."""

    COMPLETED = "completed"
    BOBS_COINCIDE = "BobsCoincide"
    STEP_UNDERFLOW = "StepUnderflow"
    NOT_FINITE = "NotFinite"
    ENCOUNTER_JUMPED = "EncounterJumped"
    NOT_CONVERGED = "NotConverged"
    NO_PROGRESS = "NoProgress"
    ENERGY_RUNAWAY = "EnergyRunaway"
    STEP_TOO_LONG = "StepTooLong"
    PASSED_THROUGH = "PassedThrough"
    CALCULATOR_FAILED = "CalculatorFailed"
    INTERRUPTED = "Interrupted"


# The status of each code that a time loop returns at its end.
STATUS_OF_CODE = {
    COMPLETED: Status.COMPLETED,
    BOBS_COINCIDE: Status.BOBS_COINCIDE,
    STEP_UNDERFLOW: Status.STEP_UNDERFLOW,
    NOT_FINITE: Status.NOT_FINITE,
    ENCOUNTER_JUMPED: Status.ENCOUNTER_JUMPED,
    NOT_CONVERGED: Status.NOT_CONVERGED,
}

MEANINGS = {
    Status.COMPLETED: "the run reached its end",
    Status.BOBS_COINCIDE: "two interacting bobs are at the same place, where their force has no "
    "direction; move one, leave a gap between their paths, or add a repulsive core",
    Status.STEP_UNDERFLOW: "the motion needs steps below the spacing of floating-point times; "
    "leave a gap between the bobs' paths, or give a finite kappa, or a potential without a jump",
    Status.NOT_FINITE: "a force or an energy is not a finite number; tribo check tells where that "
    "of a potential is none",
    Status.ENCOUNTER_JUMPED: "a step of the given size would carry bobs past an encounter; "
    "give a smaller one",
    Status.NOT_CONVERGED: "iteration did not solve the equations of a step; give a smaller step",
    Status.NO_PROGRESS: "by its progress so far, the run would take more evaluations of all forces "
    "than it may; give a lower accuracy, a shorter duration, more max_evaluations, or a method and "
    "a step",
    Status.ENERGY_RUNAWAY: "the energy grows without work, as the step is too long for the "
    "motion; give a smaller one, or an accuracy",
    Status.STEP_TOO_LONG: "the step does not resolve the stiffest motion at the temperature; "
    "give a smaller one, or none",
    Status.PASSED_THROUGH: "surfaces passed through each other: most bars of one are beyond all "
    "bobs of the other; give a smaller load, stronger contact, or denser asperites",
    Status.CALCULATOR_FAILED: "an ASE calculator raised an error, which the notes quote",
    Status.INTERRUPTED: "the run was interrupted; the result contains the samples up to there",
}
