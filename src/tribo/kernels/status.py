"""How a run can end: each outcome has a number for kernels and a name for people."""

COMPLETED, PAUSED, BOBS_COINCIDE, STEP_UNDERFLOW, NOT_FINITE, ENCOUNTER_JUMPED = range(6)

NAMES = {
    COMPLETED: "completed",
    BOBS_COINCIDE: "BobsCoincide",
    STEP_UNDERFLOW: "StepUnderflow",
    NOT_FINITE: "NotFinite",
    ENCOUNTER_JUMPED: "EncounterJumped",
}

MEANINGS = {
    "completed": "the run reached its end",
    "BobsCoincide": "two bobs that interact are at the same place; their force has no direction",
    "StepUnderflow": "the motion asks for steps below the spacing of floating-point times",
    "NotFinite": "a force or an energy is not a finite number",
    "EncounterJumped": "the given step would carry bobs past an encounter; a smaller one would do",
    "CalculatorFailed": "an ASE calculator raised an error, which the notes tell",
    "Interrupted": "the run was interrupted; what it had reached is kept",
}
