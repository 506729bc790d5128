// Requests to the server of the application, whose address contains the token.
const base = location.pathname.replace(/[^/]*$/, '');

const answer = async (response) => {
  const text = await response.text();
  let json;
  try {
    json = JSON.parse(text);
  } catch {
    throw new Error(`The server answered ${response.status} without JSON.`);
  }
  if (!response.ok) throw new Error(json.error ?? `The server answered ${response.status}.`);
  return json;
};

const reach = async (address, options) => {
  let response;
  try {
    response = await fetch(address, options);
  } catch {
    throw new Error('The application does not answer. Start it again with wheeltap app, and open the URL that it prints.');
  }
  return answer(response);
};

export const get = (what, parameters = {}) =>
  reach(`${base}api/${what}?${new URLSearchParams(parameters)}`);

export const post = (what, body) => reach(`${base}api/${what}`, {
  method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body),
});

const schemas = new Map();
export const schema = (kind) => {
  if (!schemas.has(kind)) schemas.set(kind, get('schema', { kind }));
  return schemas.get(kind);
};
