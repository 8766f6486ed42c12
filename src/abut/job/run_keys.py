"""Descriptions of the keys of a job file that say how it is run and what is read, as ``abut.job.key_descriptions``."""

from __future__ import annotations

AT = "of the loaded state: the end of a step, or a time at which a load step then ends; left out: the end of the last step"

RUN: dict[str, dict[str, str]] = {
    "FrequenciesTable": {
        "count": "how many, from the lowest",
        "stiffening": "whether stresses and centrifugal forces at the end of the last step change the stiffness; under "
        "finite kinematics always",
        "complex": "whether friction of what slips follows the pressure: frequencies with rates of growth (squeal)",
        "coriolis": "whether Coriolis forces act on what centrifugal forces say to turn: frequencies seen from there, of "
        "whirling with and against the rotation",
        "diameters": "nodal diameters of a whole of alike sectors, of each of which count frequencies are found: from 0 to "
        "half the sectors; others than 0 come twice each",
        "sectors": "how many sectors like the modelled one make up the whole turn, where there are other diameters than 0",
        "side": "the node set on one side of the sector whose equations join it to the other side, turned by one sector; "
        "all equations between it and other nodes are taken as such",
        "time": f"{AT}; 0, or start: of the model before anything acts, all contacts but ties open",
        "open": "contacts that hold nothing in the vibrations, though they press in the state",
    },
    "BucklingTable": {"count": "how many positive factors, from the smallest", "time": AT},
    "HarmonicTable": {
        "between": "first and last frequency, cycles per time",
        "loads": "as [[loads]], their values amplitudes of cosines: no temperatures, no centrifugal forces, no amplitude",
        "imaginary": "loads that go a quarter of a period ahead",
        "base": "amplitude of a shift of everything that is held [length]",
        "points": "frequencies from one natural frequency to the next, both among them",
        "bias": "how much closer they are near natural frequencies; 1: not at all",
        "damping": "share of critical damping, of all modes, or of the first, the second, ... and none of those beyond",
        "rayleigh": "of mass [1/time] and of stiffness [time]: half of the first over, and half of the second times, the "
        "angular frequency are added to the shares",
        "fields": "frequencies of which displacements everywhere are written",
        "time": AT,
    },
    "TransientTable": {
        "period": "how long [time]",
        "loads": "as [[loads]]; amplitudes are factors over times from 0 to period, what has none acts from the outset",
        "steps": "in how many equal steps results are given; modes move exactly in between",
        "damping": "as of [harmonic]",
        "rayleigh": "as of [harmonic]",
        "fields": "times of which displacements everywhere are written",
        "time": AT,
    },
    "SolveOptionsTable": {
        "steps": "load steps, equal parts of a linear ramp; auto: one, with friction as many as the onset of slip takes. "
        "With friction, a step that does not converge is taken in parts, of which only the end is written. With contact "
        "under finite kinematics a number gives the longest step, and auto leaves all of them to abut",
        "end": "time at the end of the run: all times of the file, those of amplitudes too, run from 0 to it",
        "times": "ends of the load steps, rising to the end, where they are unequal; with contact under finite kinematics "
        "further ones come between them where one does not converge",
        "linear": "linear solver; auto takes multigrid (amg) for large 3D models more than one cell thick, and petsc on "
        "several processes",
        "max_iterations": "iterations allowed in a load step; with friction, of each method that is tried in it",
        "seconds": "time that the run may take: after it the run ends with the step or the iteration that it is in, the "
        "steps done so far are written, and abut run --restart goes on from there; left out: no limit",
    },
    "StepTable": {
        "name": "a name of your choice; where a time is asked for it stands for the end of the step, start for 0",
        "period": "how long it takes",
        "increments": "load steps in it, of equal length; kinematics finite finds them where none of the steps has any",
    },
    "ResultFieldTable": {
        "file": "result file beside the job file: .vtu, or .frd as text, of which the last step counts",
        "array": "name of the values at its points, such as temperature, displacement; in .frd files NDTEMP, DISP",
        "component": "of a vector or tensor: its name in the file, x, y or z of a vector, or its number from 0",
        "body": "name or number of the file's body (in .frd files material) whose cells alone are read; left out: all",
    },
    "StartTable": {
        "results": "folder of the results of the other job, beside the job file; it was run with output.restart = true",
        "time": "the time in this job at which the other one's end is: a name of a step, or a number",
    },
    "OutputTable": {
        "restart": "whether restart files stay when the run is done, so that another job can start from its end",
        "directory": "folder of the results, beside the job file",
        "steps": "steps with result files: all, last, n for every n-th, or a list of numbers; the last one always has them. "
        "Tables, summary and report have every step",
        "fields": "what result files hold: fields of the bodies, and contact for the files of contact surfaces; "
        "principal-stress and max-shear (half the difference of the largest and the smallest) are left out unless they are "
        "named",
        "formats": "vtu: a file a step, for ParaView; vtkhdf: all steps in one, for ParaView; frd: fields.frd for "
        "CalculiX GraphiX; the last two are written at the end of the run",
        "compression": "fast, or small: VTU files up to two fifths smaller, which take longer to write; the same numbers",
    },
    "ProbeTable": {
        "name": "a name of your choice, also of its file probe_NAME.csv",
        "at": "a point of the undeformed mesh [length]",
        "line": "two points, start and end [length]",
        "on": "name of the node set, surface or body whose nodes are read",
        "points": "how many points on the line, both ends among them; left out: 50",
        "of": "what to read; left out: all there is, plastic strains only where a body may yield, pressure and gap only on "
        "surfaces of contacts, principal stresses, largest shear (max-shear) and reactions not at all",
        "contact": "name of the contact whose pressure and gap are read; left out: the one that the probe lies on",
        "body": "name of the body that is read where points lie on several; left out: the first in the mesh",
        "steps": "steps in its table: all, last, n for every n-th, or a list of numbers; the last one always is",
        "axes": "local axes at each undeformed point: x, y and z of displacement, stress, reaction and plastic strain are "
        "then along their first, second and third direction",
    },
}
