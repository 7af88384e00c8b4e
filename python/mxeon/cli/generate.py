# SPDX-License-Identifier: Apache-2.0
"""`mxeon generate`: write shader sources."""

import argparse
import glob
import json
from contextlib import closing
from functools import partial

from mxeon.cli import arguments
from mxeon.cli.batch import Source, run_batch, shader_texts, stem
from mxeon.cli.output import fail, show, status_of, warn
from mxeon.errors import PASSED, InputError, as_output
from mxeon.shaders.targets import CLASSES


def add_parser(commands: arguments.Commands) -> None:
    command = arguments.add_command(
        commands,
        "generate",
        "generate shader source from documents",
        run,
        "generate my.mtlx --target glsl --outputPath out",
        "generate *.mtlx --target osl --target mdl --outputPath out",
        "generate my.mtlx --target osl --profile cycles --outputPath out  # for Blender",
        "generate my.mtlx --target glsl --closures path --outputPath out  # for a path tracer",
    )
    command.add_argument("files", nargs="+", metavar="FILE", help="MaterialX documents")
    command.add_argument(
        "--target",
        action="append",
        required=True,
        metavar="NAME",
        help=f"shading language: {', '.join(CLASSES)}; repeatable",
    )
    command.add_argument(
        "--outputPath", metavar="DIR", required=True, help="folder to write the shaders to"
    )
    command.add_argument(
        "--element", metavar="NAME", help="generate this material only (default: all)"
    )
    command.add_argument(
        "--profile",
        "--closures",
        metavar="NAME",
        help="variant of a target: cycles, the OSL of Blender's Cycles; or path, GLSL that a path tracer includes",
    )
    names = "--library", "--materialx", "--json", "--workers", "--timeout"
    arguments.add_shared(command, *names)
    arguments.add_methods(command)
    arguments.add_policy(command)


def run(options: argparse.Namespace) -> int:
    from mxeon.io.files import below, check_output, write_text

    stems = {glob.escape(stem(file)) for file in options.files}
    names = [f"{each}.*.{target}*" for each in stems for target in options.target]
    check_output(options.outputPath, arguments.inputs(options, options.files), replaced=names)
    sources = [Source(file, target) for file in options.files for target in options.target]
    work = partial(
        shader_texts,
        element=options.element,
        library=options.library,
        profile=options.profile,
        methods=arguments.methods(options),
        policy=arguments.policy(options),
    )
    written: list[str] = []
    errors: list[Exception] = []
    with closing(run_batch(work, sources, options.workers, options.timeout)) as results:
        for source, result in zip(sources, results, strict=True):
            for warning in result.warnings:
                warn(warning)
            if result.error:
                errors.append(result.error)
                continue
            files = {below(options.outputPath, name): text for name, text in result.value.items()}
            if taken := {*map(str, files)} & {*written}:
                rule = f"must not overwrite {min(taken)} of this run; rename the document"
                errors.append(InputError(f"{source.file}: {rule}"))
                continue
            for path, text in files.items():
                write_text(path, text)
            written += map(str, files)
    lines = [line for error in errors for line in status_of(error)[1:]]
    outcome = {"files": written, "errors": lines}
    if options.json:
        print(as_output(json.dumps(outcome)))
    else:
        for each in written:
            show(each)
    return min((fail(*status_of(error)) for error in errors), default=PASSED)
