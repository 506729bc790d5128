#!/usr/bin/env python3
"""mpirun -n N wheeltap writes the same files as one process, for every N.

ranks.py PROGRAM PRELOAD CHECK...     CHECK: a function below without its "check_"

Exit code 77, and a line, without mpirun or without the module in the folder of the program.
"""
import errno
import os
import pathlib
import select
import shutil
import signal
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from durable import BEAM, CHAIN, LONGER, SHORT, SWEEP, UPDATE, Bench, expect, files, same  # noqa: E402

MPIRUN = ['mpirun', '--oversubscribe']
JOBS = (('damage', BEAM, 'damage'), ('sid', CHAIN, 'sid'), ('update', UPDATE, 'update'))
TABLE = BEAM | {'predictor': {'sites': [1, 4, 7, 9], 'multipliers': [0.4, 0.7, 1.0]}}
# A list of many models of a record, and evidence by additional methods.
TERMS = CHAIN | {'models': [{'name': f'm{i}', 'masses': [0.5], 'noise': 0.05,
                             'links': [{'between': [0, 1], 'stiffness': 'k', 'damping': 0.1,
                                        **({'cubic': 'k3'} if i & 1 else {}), **({'coulomb': 'f'} if i & 2 else {}),
                                        **({'quadratic': 'k2'} if i & 4 else {})}]} for i in range(8)],
                 'parameters': {'k': {'uniform': [0, 100]}, 'k3': {'uniform': [0, 1e4]}, 'f': {'uniform': [0, 1]},
                                'k2': {'uniform': [-100, 100]}},
                 'truth': CHAIN['truth'] | {'model': 'm1'}}


class Ranks(Bench):
    """The program as one process or as several ranks."""

    def __init__(self, program, preload):
        super().__init__(program, preload)
        self.environment |= {'OMPI_ALLOW_RUN_AS_ROOT': '1', 'OMPI_ALLOW_RUN_AS_ROOT_CONFIRM': '1'}
        self.alone = program

    def run(self, *arguments, ranks=0, **how):
        return super().run(*self.words(ranks, arguments), **how)

    def words(self, ranks, arguments):
        """Arguments of one process, or of mpirun."""
        self.program = 'mpirun' if ranks else self.alone
        return [*MPIRUN[1:], '-n', ranks, self.alone, *arguments] if ranks else list(arguments)


def compare(bench, name, command, arguments, ranks=(1, 2, 3, 5)):
    out = bench.folder / name
    words = [command, bench.case(name, arguments[0]), '-o', out, *arguments[1]]
    bench.run(*words)
    whole = files(out)
    for n in ranks:
        shutil.rmtree(out)
        bench.run(*words, ranks=n)
        same(files(out), whole)


def check_any_number_of_ranks_makes_the_same_files(bench):
    for name, case, command in JOBS:
        compare(bench, name, command, (case, SHORT))


def check_every_stage_is_the_same(bench):
    compare(bench, 'converged', 'damage', (BEAM | {'predictor': 'fe'}, ['--chains', '3', '--quiet', '--warmup', '1000']), (3,))
    compare(bench, 'evidence', 'sid', (CHAIN, [*SHORT, '--evidence=tmcmc+bridge']), (3,))
    compare(bench, 'quick', 'sid', (CHAIN, ['--quick', '--quiet']), (2,))
    compare(bench, 'terms', 'sid', (TERMS, SHORT), (3,))
    compare(bench, 'sweep', 'sid', (SWEEP, SHORT), (3,))
    compare(bench, 'prior', 'damage', (BEAM, [*SHORT, '--prior-only']), (2,))


def check_any_number_of_ranks_makes_the_same_table(bench):
    case, out = bench.case('table', TABLE), bench.folder / 'tables'
    out.mkdir()
    words = ['table', case, '-o', out / 'one.nc', '--quiet', '--resume']
    bench.run(*words)
    whole = files(out)
    expect(list(whole) == ['one.nc'], f'nothing beside the table: {sorted(whole)}')
    for n in (1, 2, 3, 5):
        shutil.rmtree(out)
        out.mkdir()
        bench.run(*words, ranks=n)
        same(files(out), whole)
    bench.run('table', case, '-o', out / 'part.nc', '--part', '1/2', '--quiet', ranks=2)
    # Ranks resume the work of one process, and one process that of ranks.
    for first, then in ((0, 3), (3, 0)):
        shutil.rmtree(out)
        out.mkdir()
        stopped_table(bench, first, words, out)
        bench.run(*words, ranks=then)
        same(files(out), whole)


def stopped_table(bench, ranks, words, out):
    """Kills the program when its journal has runs, unless it has ended before."""
    process = bench.start(*(bench.words(ranks, words) if ranks else words))
    while process.poll() is None and not any(p.stat().st_size for p in out.glob('*.runs.*')):
        pass
    left = handles(process)
    process.kill()
    process.communicate()
    # Ranks notice the end of mpirun at their next communication with it; until then they write.
    for rank in left:
        select.select([rank], [], [])
        os.close(rank)


def check_any_number_of_ranks_makes_the_same_batch(bench):
    out = bench.folder / 'batch'
    cases = [bench.case(f'case{i}', BEAM | {'title': f'Case {i}'}) for i in range(4)]
    cases += [bench.case('bad', BEAM | {'data': {'frequencies': [-1.0], 'cov': 0.01}}), bench.case('rig', CHAIN)]
    path = bench.folder / 'cases.txt'
    path.write_text('\n'.join(cases) + '\n')
    words = ['batch', path, '-o', out, *SHORT]

    def everything():
        found = {f'{folder.name}/{name}': content for folder in sorted(out.iterdir()) if folder.is_dir()
                 for name, content in files(folder).items()}
        rows = [line.split(',') for line in (out / 'batch.csv').read_text().splitlines()]
        seconds = rows[0].index('wall_seconds')
        return found, [row[:seconds] + row[seconds + 1:] for row in rows]

    bench.run(*words, '--threads', '1', code=65)
    whole, rows = everything()
    expect(len(rows) == 7, f'a row a case: {rows}')
    for n in (1, 2, 3):
        shutil.rmtree(out)
        _, said, _ = bench.run(*words, '--threads', '1', ranks=n, code=65)
        found, theirs = everything()
        same(found, whole)
        expect(theirs == rows, f'{n} ranks: {theirs}')
        expect(said.count('[') == 6, f'a line a case: {said}')


def started(bench, words, out):
    """Starts mpirun with 3 ranks and returns after the first checkpoint."""
    process = bench.start(*bench.words(3, words))
    while process.poll() is None and not (out / 'checkpoint.nc').exists():
        time.sleep(0.005)
    expect(process.poll() is None, 'it ended before its checkpoint')
    return process


def children(process):
    listed = pathlib.Path(f'/proc/{process.pid}/task/{process.pid}/children').read_text().split()
    found = []
    for pid in listed:
        command = pathlib.Path(f'/proc/{pid}/cmdline').read_bytes().split(b'\0')
        if command[0].endswith(b'wheeltap'):
            found.append(int(pid))
    return found


def handles(process):
    """Descriptors of the ranks, readable after their end."""
    if process.poll() is not None:
        return []
    found = []
    for pid in children(process):
        try:
            found.append(os.pidfd_open(pid))
        except ProcessLookupError:
            pass
    return found


def check_a_killed_rank_leaves_a_checkpoint(bench):
    for name, case, command in JOBS:
        out = bench.folder / name
        words = [command, bench.case(name, case), '-o', out, *LONGER, '--resume']
        bench.run(*words)
        whole = files(out)
        for victim in (1, 0):
            shutil.rmtree(out)
            process = started(bench, words, out)
            os.kill(children(process)[victim], signal.SIGKILL)
            _, err = process.communicate()
            expect(process.returncode != 0 and 'signal 9 (Killed)' in err, f'{name}: {process.returncode}: {err}')
            expect((out / 'checkpoint.nc').exists(), 'the checkpoint stays')
            bench.run(*words, ranks=2)  # as many as remain
            same(files(out), whole)


def check_signals_leave_a_checkpoint(bench):
    for name, case, command in JOBS:
        out = bench.folder / name
        words = [command, bench.case(name, case), '-o', out, *LONGER, '--resume']
        bench.run(*words)
        whole = files(out)
        for number in (signal.SIGUSR1, signal.SIGTERM, signal.SIGINT):
            shutil.rmtree(out)
            process = started(bench, words, out)
            process.send_signal(number)
            _, err = process.communicate()
            if number == signal.SIGUSR1:  # mpirun does not forward output after the other signals
                expect('--resume continues the run' in err and err.count('wheeltap: ') == 1, f'{name}: {err}')
            # On SIGTERM mpirun waits for a second before it forwards the signal: ranks may have ended by then.
            expect((out / 'checkpoint.nc').exists() or (out / 'posterior.nc').exists(), f'{number.name}: {err}')
            bench.run(*words)  # one process resumes it
            same(files(out), whole)


def check_errors_are_said_once(bench):
    bad = bench.case('bad', BEAM | {'data': {'frequencies': [-1.0], 'cov': 0.01}})
    good = bench.case('good', BEAM)
    (bench.folder / 'file').write_text('')
    for words, code in ((['damage', bad, '-o', bench.folder / 'o', *SHORT], 65),
                        (['damage', good, '-o', bench.folder / 'file' / 'o', *SHORT], 73),
                        (['table', good, '-o', bench.folder / 't.nc'], 65),
                        (['batch', bench.folder / 'none.txt', '-o', bench.folder / 'b'], 66),
                        (['damage', good], 64)):
        _, _, err = bench.run(*words, ranks=3, code=code)
        expect(err.count('wheeltap: ') == 1, err)
        expect('MPI_ABORT' not in err, 'they end together')
    _, out, _ = bench.run('--version', ranks=3)
    expect(out.count('wheeltap') == 1, out)


def check_threads_that_are_refused(bench):
    """Other ranks take the work of a rank that gets too few threads or none; the program never faults."""
    out = bench.folder / 'run'
    words = [bench.alone, 'damage', bench.case('beam', BEAM), '-o', out, *SHORT, '--threads', '2']
    bench.run(*words[1:])
    whole = files(out)
    bench.program = 'mpirun'
    refused = ['-x', f'LD_PRELOAD={bench.preload}', '-x', 'FAIL_CALL=pthread_create', '-x', f'FAIL_ERRNO={errno.EAGAIN}']
    lived = 0
    for at in range(1, 6):  # Open MPI needs the first ones
        for more, healthy in (([], 1), (['-x', 'FAIL_AFTER=1'], 1), (['-x', 'FAIL_AFTER=1'], 0)):
            ranks = [['-n', '1', *words]] * healthy + [['-n', str(2 - healthy), *refused, '-x', f'FAIL_AT={at}', *more, *words]]
            shutil.rmtree(out, ignore_errors=True)
            code, _, err = Bench.run(bench, *MPIRUN[1:], *[w for i, r in enumerate(ranks) for w in ([':'] if i else []) + r],
                                     code=None)
            expect('internal fault' not in err, err)
            if code == 0:
                lived += 1
                same(files(out), whole)
    expect(lived >= 6, f'only {lived} of 15 runs lived')


def check_unequal_ranks_are_refused(bench):
    good = bench.case('good', BEAM)
    words = [bench.alone, 'damage', good, '-o', bench.folder / 'o', *SHORT]
    other = ['-x', 'WHEELTAP_SIMD=avx2', *words]
    bench.program = 'mpirun'
    arguments = [*MPIRUN[1:], '-n', '1', *words, ':', '-n', '1', *other]
    _, _, err = Bench.run(bench, *arguments, code=64)
    expect('different processors' in err and '--simd baseline' in err, err)
    Bench.run(bench, *[word for a in arguments for word in ([a, '--simd', 'baseline'] if a == bench.folder / 'o' else [a])])
    # Different cases, as on machines with different folders.
    different = bench.case('different', BEAM | {'title': 'Another'})
    swapped = [different if a == good else a for a in words]
    _, _, err = Bench.run(bench, *MPIRUN[1:], '-n', '1', *words, ':', '-n', '1', *swapped, code=65)
    expect('do not have the same case' in err, err)


def main():
    program, preload, *checks = sys.argv[1:]
    if not shutil.which('mpirun') or not pathlib.Path(program).with_name('wheeltap_mpi.so').exists():
        print('skipped: no mpirun, or wheeltap was built without MPI (Debian: libopenmpi-dev openmpi-bin)')
        sys.exit(77)
    for name in checks:
        bench = Ranks(program, preload)
        try:
            globals()[f'check_{name}'](bench)
        except AssertionError as failed:
            print(f'{name}: {failed}')
            sys.exit(1)
        finally:
            shutil.rmtree(bench.folder, ignore_errors=True)
        print(f'{name}: as it should be')


if __name__ == '__main__':
    main()
