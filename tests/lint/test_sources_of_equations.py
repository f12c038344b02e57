"""Doc comments that name a paper's equation name one that exists."""

import re

import source

# Numbered equations of the papers that the project builds on, and how they are cited.
EQUATIONS = {"Gee 2007": 10, "Servant 2008": 16, "Masoud 2015": 8}

problems = []
for path in source.files("lib", "platform", "examples", "tools", "tests"):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        for author, year, tail in re.findall(r"\b(Gee|Servant|Masoud)(?: et al\.?| and \w+)?,? \(?(\d{4})\)?([^\n]*)", line):
            paper = f"{author} {year}"
            if paper not in EQUATIONS:
                problems.append(f"{source.name(path)}:{number}: there is no paper {paper}; known: {', '.join(EQUATIONS)}")
                continue
            cited = re.match(r"[,:;]?\s*(?:eqs?\.?|equations?)?\s*((?:\(?\d+\)?(?:\s*(?:-|to|and|,)\s*)?)+)", tail)
            for equation in re.findall(r"\d+", cited.group(1)) if cited else []:
                if not 1 <= int(equation) <= EQUATIONS[paper]:
                    problems.append(f"{source.name(path)}:{number}: {paper} has no equation ({equation})")
source.report(problems)
