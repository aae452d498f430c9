// Where runs come from: the page itself, a server on this machine, or a notebook.

// Runs that a page holds, for every combination of the values of its sliders: data.runs has them with
// the last slider changing first.
function heldRuns(data) {
  return {
    ...data,
    async ask(values) {
      const index = data.sliders.reduce((sum, { key, values: list }) => sum * list.length + list.indexOf(values[key]), 0);
      return data.runs[index];
    },
  };
}

// A server that simulates; the token is in the address of the page.
function servedRuns(data) {
  const token = new URLSearchParams(window.location.search).get("token");
  return {
    ...data,
    async ask(values) {
      const answer = await fetch("run", {
        method: "POST",
        headers: { "Content-Type": "application/json", "X-Tribo-Token": token },
        body: JSON.stringify(values),
      });
      const found = await answer.json();
      if (!answer.ok) throw new Error(found.error);
      return found;
    },
  };
}

// A notebook: messages to its kernel, answered in order.
function modelRuns(model) {
  const waiting = [];
  model.on("msg:custom", ({ run, error }) => {
    const { resolve, reject } = waiting.shift() ?? {};
    if (error) reject?.(new Error(error));
    else resolve?.(run);
  });
  return {
    ...model.get("source"),
    ask: (values) => new Promise((resolve, reject) => {
      waiting.push({ resolve, reject });
      model.send(values);
    }),
  };
}

// Asks for one run at a time; of the values that come meanwhile, the last ones are asked for next.
function oneAtATime(ask, done, failed) {
  let wanted = null;
  let busy = false;
  return async function request(values) {
    wanted = values;
    if (busy) return;
    busy = true;
    while (wanted !== null) {
      const asked = wanted;
      wanted = null;
      try {
        done(await ask(asked), asked);
      } catch (error) {
        failed(error);
      }
    }
    busy = false;
  };
}
