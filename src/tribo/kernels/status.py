"""How a run can end: each outcome has a number for kernels and a name for people."""

COMPLETED, PAUSED, BOBS_COINCIDE, STEP_UNDERFLOW = range(4)
NOT_FINITE, ENCOUNTER_JUMPED, NOT_CONVERGED = range(4, 7)

NAMES = {
    COMPLETED: "completed",
    BOBS_COINCIDE: "BobsCoincide",
    STEP_UNDERFLOW: "StepUnderflow",
    NOT_FINITE: "NotFinite",
    ENCOUNTER_JUMPED: "EncounterJumped",
    NOT_CONVERGED: "NotConverged",
}

MEANINGS = {
    "completed": "the run reached its end",
    "BobsCoincide": "two bobs that interact are at the same place; their force has no direction",
    "StepUnderflow": "the motion asks for steps below the spacing of floating-point times",
    "NotFinite": "a force or an energy is not a finite number",
    "EncounterJumped": "the given step would carry bobs past an encounter; a smaller one would do",
    "NotConverged": "the equations of a step were not solved by iteration; a smaller step would do",
    "CalculatorFailed": "an ASE calculator raised an error, which the notes tell",
    "Interrupted": "the run was interrupted; what it had reached is kept",
}
