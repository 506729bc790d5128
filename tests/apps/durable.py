#!/usr/bin/env python3
"""Failures of the machine neither lose a finished result nor leave a half-written one.

durable.py PROGRAM PRELOAD CHECK... [--kills N]     CHECK: a function below without its "check_"

Kills at random instants: `durable.py PROGRAM PRELOAD kills --kills 200` takes some minutes.
"""
import argparse
import errno
import json
import math
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

BEAM = {
    'kind': 'damage', 'title': 'A small case',
    'beam': {'length': 1.0, 'elements': 10, 'supports': 'simply-supported',
             'material': {'young': 70e9, 'poisson': 0.3, 'density': 2700},
             'section': {'shape': 'rectangle', 'width': 0.025, 'height': 0.006}},
    'data': {'frequencies': [13.8, 55.3, 124.0], 'cov': 0.01},
    'damage': {'count': {'min': 0, 'max': 2, 'prior': 'uniform'},
               'location': {'uniform': [0.0, 1.0]}, 'reduction': {'uniform': [0.0, 0.6]}},
    'predictor': 'fe'}
TABLE = BEAM | {'predictor': {'sites': 'every-element', 'multipliers': [0.4, 0.6, 0.8, 1.0], 'holdout': 20}}
CHAIN = {
    'kind': 'sid', 'title': 'One mass',
    'record': {'channels': [{'column': 'force [N]', 'role': 'force', 'mass': 1},
                            {'column': 'displacement [m]', 'role': 'response', 'mass': 1,
                             'quantity': 'displacement'}]},
    'parameters': {'k': {'uniform': [0, 100]}, 'k3': {'uniform': [0, 1e4]}},
    'models': [{'name': name, 'prior': 0.5, 'masses': [0.5], 'noise': 0.05,
                'links': [{'between': [0, 1], 'stiffness': 'k', 'damping': 0.1, **law}]}
               for name, law in (('linear', {}), ('duffing', {'cubic': 'k3'}))],
    'truth': {'model': 'duffing', 'parameters': {'k': 50, 'k3': 1000}, 'noise': 0.05, 'samples': 60,
              'sample_rate': 100, 'seed': 1,
              'excitation': [{'mass': 1, 'kind': 'white', 'variance': 100}]}}
SWEEP = CHAIN | {'sweep': {'path': '/truth/parameters/k3', 'values': [100, 800, 1500, 3000]}}
LONG = 'WHEELTAP_LONG_TESTS' in os.environ  # every call, signal and sort of run together; a share of them otherwise
LITTLE = 128 << 20 if 'ASAN_OPTIONS' not in os.environ else None  # bytes; sanitizers (scripts/sanitize) map far more
SHORT = ['--chains', '2', '--warmup', '200', '--draws', '200', '--search', '20', '--quiet']
COMMIT_FILES = ['posterior.nc', 'report.html', 'summary.json', 'summary.txt']


class Bench:
    """The program, in a folder of its own."""

    def __init__(self, program, preload):
        self.program, self.preload = program, preload
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix='wheeltap-durable-'))
        self.environment = os.environ | {'SOURCE_DATE_EPOCH': '1700000000'}

    def case(self, name, case):
        path = self.folder / f'{name}.json'
        path.write_text(json.dumps(case))
        return str(path)

    def start(self, *arguments, fail=None, limit=None, memory=None, **more):
        environment = self.environment
        if fail:
            environment = environment | {'LD_PRELOAD': self.preload} | {k: str(v) for k, v in fail.items()}
        limits = [(of, most) for of, most in ((resource.RLIMIT_FSIZE, limit), (resource.RLIMIT_DATA, memory)) if most]
        before = (lambda: [resource.setrlimit(of, (most, most)) for of, most in limits]) if limits else None
        return subprocess.Popen([self.program, *map(str, arguments)], env=environment, preexec_fn=before,
                                stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                **({'stdout': subprocess.PIPE} | more))

    def run(self, *arguments, code=0, **more):
        process = self.start(*arguments, **more)
        out, err = process.communicate()
        expect(code is None or process.returncode == code, f'{arguments} ended with {process.returncode}: {err}')
        return process.returncode, out, err


def expect(truth, message):
    if not truth:
        raise AssertionError(message)


def files(folder):
    return {p.name: p.read_bytes() for p in sorted(folder.iterdir())} if folder.is_dir() else {}


def one_line(err):
    expect(err.count('\n') == 1 and err.startswith('wheeltap: '), f'not one line: {err!r}')


def timeless(found):
    """The files of a run without wall seconds."""
    seconds = re.compile(rb'"(?:wall_seconds|seconds_a_likelihood)": ?[-+.0-9e]+|Time</dt>|\d[\d.,e-]* s\b[^<"]*')
    return {name: content if name.endswith('.nc') else seconds.sub(b'', content) for name, content in found.items()}


def same(a, b):
    a, b = timeless(a), timeless(b)
    expect(a.keys() == b.keys(), f'{sorted(a)} and {sorted(b)}')
    for name in a:
        if a[name] == b[name]:
            continue
        at = next(i for i, (x, y) in enumerate(zip(a[name] + b'\0', b[name] + b'\1')) if x != y)
        raise AssertionError(f'{name} differs at {at}: {a[name][at - 60:at + 60]} and {b[name][at - 60:at + 60]}')


def damage(bench, out, *more):
    return ['damage', bench.case('beam', BEAM), '-o', out, *SHORT, *more]


def check_full_disk(bench):
    """posterior.nc does not fit on the disk: exit 73, one line; the numbers and the report exist and state this."""
    out = bench.folder / 'run'
    big = ['damage', bench.case('beam', BEAM), '-o', out, '--chains', '2', '--warmup', '200', '--draws', '40000',
           '--search', '20', '--quiet']
    bench.run(*big)
    whole = files(out)
    limit = max(len(whole['report.html']), len(whole['summary.json'])) + 50000
    expect(limit < len(whole['posterior.nc']), 'the draws are what is large')
    shutil.rmtree(out)
    _, printed, err = bench.run(*big, limit=limit, code=73)
    one_line(err)
    expect('posterior.nc' in err and 'summary.json' in err, err)
    expect('A small case' in printed, 'the terminal has the summary')
    expect(sorted(files(out)) == ['report.html', 'summary.json', 'summary.txt'], sorted(files(out)))
    summary = json.loads((out / 'summary.json').read_text())
    expect(summary['models'] == json.loads(whole['summary.json'])['models'], 'the same numbers')
    expect(summary['files']['posterior.nc'] is None, summary['files'])
    expect('could not be written' in summary['diagnostics']['warnings'][0], summary['diagnostics'])
    bench.run('report', out)
    # An earlier run in the folder stays unchanged.
    bench.run(*damage(bench, out))
    before = files(out)
    _, _, err = bench.run(*big, '--seed', '2', limit=limit, code=73)
    one_line(err)
    after = files(out)
    unkept = json.loads(after.pop('summary.unkept.json'))
    expect(unkept['wheeltap']['seed'] == 2, 'this run')
    expect(after == before, 'the earlier run is unchanged')


def check_many_draws_are_not_held(bench):
    """A run with more draws than memory: the same files with little memory; exit 73 on a full disk."""
    out = bench.folder / 'run'
    many = ['damage', bench.case('beam', BEAM | {'damage': BEAM['damage'] | {'count': {'min': 0, 'max': 4, 'prior': 'uniform'}}}),
            '-o', out, '--prior-only', '--chains', '4', '--threads', '2', '--warmup', '200', '--draws', '200000', '--quiet']
    bench.run(*many, '--checkpoint', '0.5', memory=LITTLE)
    whole = files(out)
    expect(sorted(whole) == COMMIT_FILES, sorted(whole))
    bench.run('report', out, memory=LITTLE)
    bench.run(*many, '--resume', memory=LITTLE)
    same(whole, files(out))
    # Draws that the file system accepted but cannot store are lost: fsync 5 follows those of the four result files.
    fail = {'FAIL_CALL': 'fsync', 'FAIL_AT': 5, 'FAIL_UNDER': bench.folder}
    _, _, err = bench.run(*many, '--checkpoint', '0', fail=fail, code=73)
    one_line(err)
    expect('the draws stored in this folder are lost: No space left' in err, err)
    same(whole, files(out))
    shutil.rmtree(out)
    limit = max(len(whole['report.html']), len(whole['summary.json'])) + 50000
    expect(limit < len(whole['posterior.nc']), 'the draws are what is large')
    _, _, err = bench.run(*many, limit=limit, code=73)
    expect('posterior.nc: File too large' in err, err)
    expect(sorted(files(out)) == ['report.html', 'summary.json', 'summary.txt'], sorted(files(out)))
    expect(json.loads((out / 'summary.json').read_text())['models'] == json.loads(whole['summary.json'])['models'], 'the same numbers')


def check_file_size_limit_ends_with_73(bench):
    """SIGXFSZ does not end the program."""
    table = bench.case('table', TABLE)
    _, _, err = bench.run('table', table, '-o', bench.folder / 't.nc', '--quiet', limit=20000, code=73)
    one_line(err)
    expect(not (bench.folder / 't.nc').exists(), 'nothing half-written')


def check_failed_calls(bench):
    """Failure of the n-th write, rename, fsync, open, link, ftruncate, for all n; of this call or of all from it on."""
    out = bench.folder / 'run'
    bench.run(*damage(bench, out))
    before = files(out)
    for call in ('write', 'rename', 'fsync', 'open', 'link', 'ftruncate', 'posix_fallocate'):
        for after in (False, True):
            for n in range(1, 100, 3 if after and not LONG else 1):
                fail = {'FAIL_CALL': call, 'FAIL_AT': n, 'FAIL_UNDER': bench.folder} | ({'FAIL_AFTER': 1} if after else {})
                what = f'{call} {n}{" and after" if after else ""}'
                again = bench.run(*damage(bench, out, '--seed', '2'), fail=fail, code=None)
                now = files(out)
                now.pop('summary.unkept.json', None)
                expect(again[0] in (0, 73), f'{what}: {again}')
                if (out / '.wheeltap-commit').exists():  # undoing failed as well
                    bench.run('report', out)
                    expect(sorted(files(out)) == COMMIT_FILES, f'{what}: {sorted(files(out))}')
                    expect(json.loads((out / 'summary.json').read_text())['wheeltap']['seed'] == 2, 'the new run, whole')
                elif again[0] == 73:
                    one_line(again[2])
                    left = {k: v for k, v in now.items() if '.part' not in k and k != '.wheeltap-commit'}
                    expect(left == before, f'{what}: the earlier run changed: {sorted(now)}')
                fresh = bench.folder / 'fresh'
                first = bench.run(*damage(bench, fresh), fail=fail, code=None)
                expect(first[0] in (0, 73), f'{what}: {first}')
                if first[0] == 73 and (fresh / 'summary.json').exists():
                    json.loads((fresh / 'summary.json').read_text())
                    bench.run('report', fresh)
                shutil.rmtree(fresh, ignore_errors=True)
                shutil.rmtree(out)
                out.mkdir()
                for name, content in before.items():
                    (out / name).write_bytes(content)
                if again[0] == 0 and first[0] == 0:
                    break  # no more such calls (or without effect: folders, links)


def check_init_writes_all_or_nothing(bench):
    """A disk that fills up during `wheeltap init` leaves no case without its record."""
    for call in ('write', 'rename', 'fsync', 'open', 'ftruncate'):
        for n in range(1, 30):
            out = bench.folder / 'start'
            fail = {'FAIL_CALL': call, 'FAIL_AT': n, 'FAIL_UNDER': bench.folder}
            code, _, err = bench.run('init', 'sid', '-o', out, fail=fail, code=None)
            found = sorted(files(out))
            shutil.rmtree(out, ignore_errors=True)
            if code == 0:
                expect('sid.json' in found and len(found) == 3, found)
                break
            expect(code == 73, f'{call} {n}: {code}: {err}')
            one_line(err)
            expect(found == [], f'{call} {n}: {found}')
        expect(code == 0, f'{call} is never done without')


def vibration(path, frequencies):
    """Writes two channels of a record [m/s2] at 50 Hz: two lightly damped modes under noise."""
    randomly, rows, states = random.Random(1), ['a [m/s2],b [m/s2]'], [(0.0, 0.0)] * len(frequencies)
    for _ in range(3000):
        for i, f in enumerate(frequencies):
            radius, angle = math.exp(-0.02 * 2 * math.pi * f / 50), 2 * math.pi * f / 50
            x, before = states[i]
            states[i] = 2 * radius * math.cos(angle) * x - radius**2 * before + randomly.gauss(0, 1), x
        rows.append(f'{states[0][0] + states[1][0]:.6g},{states[0][0] - states[1][0]:.6g}')
    path.write_text('\n'.join(rows) + '\n')


def check_modes_are_kept_as_a_whole(bench):
    """A modal run killed before one of its renames leaves the files of the earlier run or its own, never a mixture."""
    record = {'file': 'record.csv', 'sample_rate': 50,
              'channels': [{'column': c + ' [m/s2]', 'role': 'response', 'node': c, 'direction': 'x'} for c in 'ab']}
    case = bench.case('modal', {'kind': 'modal', 'record': record, 'band': [1, 15], 'order': {'max': 20}})
    out, runs = bench.folder / 'run', []
    for frequencies in ([3.0, 8.0], [4.0, 9.0]):
        vibration(bench.folder / 'record.csv', frequencies)
        bench.run('modal', case, '-o', out, '--quiet')
        runs.append(timeless(files(out)))
    expect(sorted(runs[0]) == ['modes.json', 'poles.json', 'report.html', 'summary.json'], sorted(runs[0]))
    expect(runs[0]['modes.json'] != runs[1]['modes.json'], 'two runs')
    seen = set()
    for n in range(1, 20):
        vibration(bench.folder / 'record.csv', [3.0, 8.0])
        bench.run('modal', case, '-o', out, '--quiet')
        vibration(bench.folder / 'record.csv', [4.0, 9.0])
        fail = {'FAIL_CALL': 'rename', 'FAIL_AT': n, 'FAIL_UNDER': bench.folder, 'FAIL_KILL': 1}
        code, _, _ = bench.run('modal', case, '-o', out, '--quiet', fail=fail, code=None)
        bench.run('report', out)
        found = timeless({name: content for name, content in files(out).items() if name in runs[0]})
        which = [i for i, run in enumerate(runs) if found['modes.json'] == run['modes.json']]
        expect(len(which) == 1 and found['summary.json'] == runs[which[0]]['summary.json'], f'killed at rename {n}')
        seen.add(which[0])
        if code == 0:
            break
        expect(code == -signal.SIGKILL, f'{code}')
    expect(seen == {0, 1} and n > 3, f'{seen}, {n}')


def check_threads_that_are_refused(bench):
    """At the limit of processes, fewer threads write the same files."""
    out = bench.folder / 'run'
    bench.run(*damage(bench, out, '--threads', '4'))
    whole = files(out)
    for call, after in (('pthread_create', False), ('pthread_create', True), ('fork', True)):
        fail = {'FAIL_CALL': call, 'FAIL_AT': 1, 'FAIL_ERRNO': errno.EAGAIN} | ({'FAIL_AFTER': 1} if after else {})
        bench.run(*damage(bench, out, '--threads', '4'), fail=fail)
        same(whole, files(out))


def check_resume_refuses_a_truncated_posterior(bench):
    out = bench.folder / 'run'
    bench.run(*damage(bench, out))
    whole = (out / 'posterior.nc').read_bytes()
    (out / 'posterior.nc').write_bytes(whole[:len(whole) // 2])
    for command in (damage(bench, out, '--resume'), ['report', out]):
        _, _, err = bench.run(*command, code=65)
        expect('is truncated' in err, err)
    (out / 'posterior.nc').write_bytes(whole[:5000] + bytes([whole[5000] ^ 1]) + whole[5001:])
    for command in (damage(bench, out, '--resume'), ['report', out]):
        _, _, err = bench.run(*command, code=65)
        expect('corrupt' in err or 'another run' in err, err)


def check_resume_refuses_the_posterior_of_another_run(bench):
    out, other = bench.folder / 'run', bench.folder / 'other'
    bench.run(*damage(bench, out))
    bench.run(*damage(bench, other, '--seed', '2'))
    shutil.copy(other / 'posterior.nc', out / 'posterior.nc')
    for command in (damage(bench, out, '--resume'), ['report', out]):
        _, _, err = bench.run(*command, code=65)
        one_line(err)
        expect('is of another run' in err, err)


def check_table_keeps_what_is_not_its_journal(bench):
    table = bench.case('table', TABLE)
    mine = bench.folder / 't.nc.runs.count_1'
    mine.write_text('my notes')
    _, _, err = bench.run('table', table, '-o', bench.folder / 't.nc', '--quiet', code=73)
    one_line(err)
    expect(mine.read_text() == 'my notes', 'kept')
    mine.unlink()
    (bench.folder / 'notes').write_text('')
    mine.symlink_to(bench.folder / 'notes')
    bench.run('table', table, '-o', bench.folder / 't.nc', '--quiet', '--resume', code=73)
    expect((bench.folder / 'notes').read_text() == '', 'a link is not followed')


def until(process, condition):
    """Wait until the condition is true or the process has ended, without taking a core from the other tests."""
    while not condition():
        try:
            process.wait(timeout=0.002)
            return
        except subprocess.TimeoutExpired:
            pass


def sweep(bench, out, *more):
    return ['sid', bench.case('sweep', SWEEP), '-o', out, *SHORT, *more]


def interrupted_sweep(bench, out, number):
    """Exit code and standard error of a sweep that a signal ends when the journal has a row."""
    process = bench.start(*sweep(bench, out), stdout=subprocess.DEVNULL)
    journal = out / 'sweep.rows'
    until(process, lambda: journal.exists() and journal.read_bytes().count(b'\n') > 1)
    process.send_signal(number)
    _, err = process.communicate()
    return process.returncode, err


def check_interrupted_sweeps_keep_their_rows(bench):
    whole = bench.folder / 'whole'
    bench.run(*sweep(bench, whole))
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
        out = bench.folder / number.name
        code, err = interrupted_sweep(bench, out, number)
        if number != signal.SIGKILL:
            expect(code == 130, f'{number.name}: {code}: {err}')
            one_line(err)
            rows = json.loads((out / 'summary.json').read_text())['sweep']['rows']
            expect(0 < len(rows) < 4, f'{len(rows)} rows')
        bench.run(*sweep(bench, out, '--resume'))
        # The command lines differ.
        found = {k: v.replace(b' --resume', b'').replace(str(out).encode(), str(whole).encode()) for k, v in files(out).items()}
        numbers = json.loads(found['summary.json']), json.loads(files(whole)['summary.json'])
        for summary in numbers:
            for row in summary['sweep']['rows']:
                del row['cost']['wall_seconds']
        expect(numbers[0] == numbers[1], f'{number.name}: not the same numbers')
        expect(found['sweep.csv'] == files(whole)['sweep.csv'] and found.keys() == files(whole).keys(), sorted(found))
        _, _, err = bench.run(*[a for a in sweep(bench, out, '--resume') if a != '--quiet'])
        expect('nothing is run again' in err, err)


def check_a_reader_who_leaves_costs_nothing(bench):
    for name, command in (('sweep', sweep), ('damage', damage)):
        out = bench.folder / name
        process = bench.start(*command(bench, out))
        process.stdout.close()
        err = process.stderr.read()
        expect(process.wait() == 73, f'{process.returncode}: {err}')
        expect((out / 'summary.json').exists() and not (out / 'sweep.rows').exists(), sorted(files(out)))


def check_the_same_seed_makes_the_same_files(bench):
    for name, case, command in (('damage', BEAM, 'damage'), ('sid', CHAIN, 'sid'), ('sweep', SWEEP, 'sid'), ('table', TABLE, 'table')):
        path, found = bench.case(name, case), []
        for _ in range(2):
            out = bench.folder / ('t.nc' if name == 'table' else name)
            bench.run(command, path, '-o', out, *(['--quiet'] if name == 'table' else SHORT))
            found.append({'t.nc': out.read_bytes()} if name == 'table' else files(out))
            out.unlink() if name == 'table' else shutil.rmtree(out)
        same(*found)


LONGER = ['--chains', '2', '--warmup', '2000', '--draws', '2000', '--search', '20', '--quiet', '--checkpoint', '0.01']


FRAME = json.loads((pathlib.Path(__file__).parents[2] / 'data/structures/cracked-portal.json').read_text())


UPDATE = json.loads((pathlib.Path(__file__).parents[2] / 'data/structures/storeys-update.json').read_text())


def resumable(bench, *more):
    """Name, arguments and folder of a run of each kind with checkpoints."""
    return [(name, [command, bench.case(name, case), '-o', bench.folder / name, *LONGER, '--resume'], bench.folder / name)
            for name, case, command in (('damage', BEAM, 'damage'), ('sid', CHAIN, 'sid'), ('sweep', SWEEP, 'sid'), *more)]


def until_checkpoint(bench, arguments, out, number):
    """Sends the signal after the first checkpoint; returns exit code and standard error."""
    process = bench.start(*arguments, stdout=subprocess.DEVNULL)
    until(process, (out / 'checkpoint.nc').exists)
    process.send_signal(number)
    _, err = process.communicate()
    return process.returncode, err


def check_signals_leave_a_checkpoint(bench):
    """A signal causes one line and a checkpoint; --resume writes the files of an undisturbed run."""
    for name, arguments, out in resumable(bench):
        bench.run(*arguments)
        whole = files(out)
        signals = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1, signal.SIGUSR2, signal.SIGXCPU)
        for number in signals if LONG else signals[:2] if name == 'damage' else signals[1:2]:
            shutil.rmtree(out)
            code, err = until_checkpoint(bench, arguments, out, number)
            expect(code in (0, 130), f'{name}, {number.name}: {code}: {err}')
            one_line(err)
            expect('--resume' in err and (out / 'checkpoint.nc').exists(), f'{name}, {number.name}: {err}')
            bench.run(*arguments)
            same(files(out), whole)
        # Without --resume a new run begins.
        until_checkpoint(bench, arguments, out, signal.SIGKILL)
        bench.run(*[a for a in arguments if a != '--resume'])
        expect(files(out).keys() == whole.keys(), sorted(files(out)))
        shutil.rmtree(out)


def check_signals_that_come_twice_are_one(bench):
    """`timeout` and schedulers send a signal to the program and to its process group."""
    name, arguments, out = resumable(bench)[0]
    bench.run(*arguments)
    whole = files(out)
    for number in (signal.SIGINT, signal.SIGTERM):
        shutil.rmtree(out)
        process = bench.start(*arguments, stdout=subprocess.DEVNULL)
        until(process, (out / 'checkpoint.nc').exists)
        asked = time.monotonic()
        while process.poll() is None and time.monotonic() - asked < 0.5:
            process.send_signal(number)
        _, err = process.communicate()
        expect(process.returncode in (0, 130), f'{number.name}: {process.returncode}: {err}')
        expect('--resume' in err and (out / 'checkpoint.nc').exists(), f'{number.name}: {err}')
        bench.run(*arguments)
        same(files(out), whole)


def check_foreign_checkpoints_are_refused(bench):
    for name, arguments, out in resumable(bench):
        until_checkpoint(bench, arguments, out, signal.SIGKILL)
        path = out / 'checkpoint.nc'
        whole = path.read_bytes()
        expect(len(whole) > 1000, 'the checkpoint exists')
        if name != 'sweep':  # the journal of a sweep rejects these
            more_draws = [a if a != '2000' or b != '--draws' else '2001' for a, b in zip(arguments, ['', *arguments])]
            for other, what in (([*arguments, '--seed', '7'], 'the seed was 1 and is 7'),
                                (more_draws, '/draws was 2000 and is 2001'),
                                ([*arguments, '--set', 'title=Another'], '/title was')):
                _, _, err = bench.run(*other, code=65)
                one_line(err)
                expect(what in err and 'checkpoint.nc' in err, err)
        randomly = random.Random(1)
        broken = [whole[:n] for n in (0, 4, 100, len(whole) // 2, len(whole) - 17, len(whole) - 1)] + [b'my notes', whole + b'x']
        for _ in range(40):
            at = randomly.randrange(len(whole))
            broken.append(whole[:at] + bytes([whole[at] ^ 1 << randomly.randrange(8)]) + whole[at + 1:])
        for content in broken:
            path.write_bytes(content)
            _, _, err = bench.run(*arguments, code=65)
            one_line(err)
            expect('checkpoint.nc' in err, err)
            expect(path.read_bytes() == content, 'the file is unchanged')
        path.write_bytes(b'my notes')
        _, _, err = bench.run(*[a for a in arguments if a != '--resume'], code=73)
        one_line(err)
        expect('in the way' in err and path.read_bytes() == b'my notes', err)
        path.write_bytes(whole)
        bench.run(*arguments)
        expect(not path.exists(), 'a finished run removes it')


def check_kills_between_checkpoints(bench, kills=30 if LONG else 12):
    """Runs that are killed and resumed until they end write the files of an undisturbed run."""
    randomly = random.Random(os.environ.get('SEED', '1'))
    jobs = []
    for name, arguments, out in resumable(bench, ('frame', FRAME, 'damage')):
        began = os.times().elapsed
        bench.run(*arguments)
        jobs.append((name, arguments, out, files(out), os.times().elapsed - began))
    killed = taken_up = 0
    while killed < kills:
        for name, arguments, out, whole, seconds in jobs:
            shutil.rmtree(out)
            longest = 0.7 * seconds
            while True:
                process = bench.start(*arguments, stdout=subprocess.DEVNULL)
                try:
                    # Each attempt repeats the work after the last checkpoint: longer times let it finish, also on a
                    # machine that has become slower.
                    longest *= 1.1
                    process.wait(randomly.uniform(0, longest))
                    _, err = process.communicate()
                    expect(process.returncode == 0, f'{name}: {process.returncode}: {err}')
                    break
                except subprocess.TimeoutExpired:
                    process.kill()
                process.communicate()
                killed += 1
                taken_up += (out / 'checkpoint.nc').exists()
            same(files(out), whole)
    expect(taken_up > kills / 4, f'{taken_up} of {killed} left a checkpoint')
    print(f'{killed} kills, {taken_up} of them with a checkpoint')


def batch(bench):
    """Arguments and folder of a batch with a case of each kind."""
    cases = [bench.case(name, case) for name, case in (('beam', BEAM), ('chain', CHAIN), ('sweep', SWEEP), ('beam2', BEAM | {'title': 'Another'}))]
    plan, out = bench.folder / 'list.txt', bench.folder / 'out'
    plan.write_text('\n'.join(cases))
    return ['batch', plan, *LONGER, '--threads', '2', '-o', out, '--resume'], out


def runs_of(out):
    return {f'{one.name}/{name}': content for one in sorted(out.iterdir()) if one.is_dir() for name, content in files(one).items()}


def check_interrupted_batches_go_on(bench):
    """A batch stopped or killed with several running cases: --resume writes the files of an undisturbed batch."""
    command, out = batch(bench)
    bench.run(*command)
    whole, table = runs_of(out), (out / 'batch.csv').read_text().splitlines()
    expect([line.split(',')[:3] for line in table[1:]] ==
           [['beam', 'damage', '0'], ['chain', 'sid', '0'], ['sweep', 'sid', '0'], ['beam2', 'damage', '0']], table)
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1, signal.SIGUSR2, signal.SIGKILL) if LONG else (signal.SIGTERM, signal.SIGKILL):
        shutil.rmtree(out)
        process = bench.start(*command, stdout=subprocess.DEVNULL)
        until(process, lambda: len(list(out.glob('*/checkpoint.nc'))) > 1)
        process.send_signal(number)
        _, err = process.communicate()
        if number != signal.SIGKILL:
            expect(process.returncode == 130, f'{number.name}: {process.returncode}: {err}')
            one_line(err)
            expect('--resume continues' in err and list(out.glob('*/checkpoint.nc')), f'{number.name}: {err}')
        bench.run(*command)
        same(runs_of(out), whole)


def check_kills_of_batches(bench, kills=6 if LONG else 4):
    """A batch that is killed and resumed until it ends, with the programs that it started."""
    randomly = random.Random(os.environ.get('SEED', '1'))
    command, out = batch(bench)
    began = os.times().elapsed
    bench.run(*command)
    whole, seconds, killed = runs_of(out), os.times().elapsed - began, 0
    while killed < kills:
        shutil.rmtree(out)
        longest = 0.7 * seconds
        while True:
            process = bench.start(*command, stdout=subprocess.DEVNULL)
            try:
                longest *= 1.1  # as above
                process.wait(randomly.uniform(0, longest))
                _, err = process.communicate()
                expect(process.returncode == 0, f'{process.returncode}: {err}')
                break
            except subprocess.TimeoutExpired:
                process.kill()
            process.communicate()
            killed += 1
        same(runs_of(out), whole)
        expect(sorted(p.name for p in out.iterdir()) == ['batch.csv', 'batch.json', 'beam', 'beam2', 'chain', 'sweep'], 'no stray file')
    print(f'{killed} kills')


def check_kills_of_monitoring(bench, kills=12):
    """A call with new rows that is killed, and then repeated, gives the bits of a call that was not."""
    randomly = random.Random(os.environ.get('SEED', '1'))
    folder = bench.folder / 'bridge'
    bench.run('init', 'monitor', '-o', folder)
    rows = (folder / 'monitor.csv').read_text().splitlines(keepends=True)
    case = json.loads((folder / 'monitor.json').read_text()) | {'learning': {'until': 300, 'hinges': 1}}
    (folder / 'monitor.json').write_text(json.dumps(case))
    command = ['monitor', folder / 'monitor.json', '-o', folder / 'out', '--quiet', '--resume']

    def results():
        found = files(folder / 'out')
        expect(sorted(found) == ['report.html', 'series.csv', 'state.nc', 'summary.json'], sorted(found))
        return found['series.csv'], found['state.nc'], json.loads(found['summary.json'])['monitor']

    def call(seconds=None):
        began = os.times().elapsed
        process = bench.start(*command, stdout=subprocess.DEVNULL)
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.kill()
        process.communicate()
        return os.times().elapsed - began

    (folder / 'monitor.csv').write_text(''.join(rows[:201]))
    call()
    shutil.copytree(folder / 'out', folder / 'before')
    (folder / 'monitor.csv').write_text(''.join(rows[:1201]))
    seconds = call()
    whole = results()
    for _ in range(kills):
        shutil.rmtree(folder / 'out')
        shutil.copytree(folder / 'before', folder / 'out')
        call(randomly.uniform(0, 1.2 * seconds))
        call()
        expect(results() == whole, 'a repeated call gives other bits')
    print(f'{kills} kills in calls of {seconds:.2g} s')


def check_kills(bench, kills=8):
    """After SIGKILL at random instants, --resume writes the files of an undisturbed run."""
    randomly = random.Random(os.environ.get('SEED', '1'))
    jobs = []
    for name, case, command in (('table', TABLE, 'table'), ('damage', BEAM, 'damage'), ('sid', CHAIN, 'sid'), ('sweep', SWEEP, 'sid')):
        out = bench.folder / name / 'out'
        out.parent.mkdir()
        target = out / 't.nc' if name == 'table' else out
        (out.mkdir() if name == 'table' else None)
        arguments = [command, bench.case(name, case), '-o', target, *(['--quiet'] if name == 'table' else SHORT), '--resume']
        began = os.times().elapsed
        bench.run(*arguments)
        jobs.append((out, arguments, files(out), os.times().elapsed - began, name == 'table'))
    for i in range(kills):
        out, arguments, whole, seconds, empty = jobs[i % len(jobs)]
        shutil.rmtree(out)
        if empty:
            out.mkdir()
        process = bench.start(*arguments, stdout=subprocess.DEVNULL)
        try:
            process.wait(randomly.uniform(0, 1.1 * seconds))
        except subprocess.TimeoutExpired:
            process.kill()
        process.communicate()
        for name in ('summary.json', 'sweep.csv', 'posterior.nc', 't.nc'):
            if name in whole and (out / name).exists() and not (out / '.wheeltap-commit').exists():
                found, wanted = timeless({name: (out / name).read_bytes()}), timeless({name: whole[name]})
                expect(found == wanted or name.endswith('.json'), f'{name} half-written after kill {i}')
        bench.run(*arguments)
        now = files(out)
        expect(now.keys() == whole.keys(), f'kill {i} of {out}: {sorted(now)}')
        same({k: v for k, v in now.items() if k.endswith(('.nc', '.csv', '.txt'))},
             {k: v for k, v in whole.items() if k.endswith(('.nc', '.csv', '.txt'))})
    print(f'{kills} kills')


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('program')
    parser.add_argument('preload', type=lambda path: str(pathlib.Path(path).resolve(strict=True)))
    parser.add_argument('checks', nargs='+')
    parser.add_argument('--kills', type=int)
    options = parser.parse_args()
    for name in options.checks:
        bench = Bench(options.program, options.preload)
        try:
            globals()[f'check_{name}'](bench, **({'kills': options.kills} if name.startswith('kills') and options.kills else {}))
        except AssertionError as failed:
            print(f'{name}: {failed}')
            sys.exit(1)
        finally:
            shutil.rmtree(bench.folder, ignore_errors=True)
        print(f'{name}: as it should be')


if __name__ == '__main__':
    main()
